#include "groundscale/calibration/camera_height.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "groundscale/calibration/speed_pairs.hpp"
#include "groundscale/core/check.hpp"

namespace groundscale {
namespace {

constexpr double kBlockS = 5.0;
constexpr std::size_t kFewestBlocks = 4;
constexpr std::size_t kMostBlocks = 20;
/// As for the clock offset: a pair counts as half a one.
constexpr double kPairsAPair = 2.0;

double square(double x) { return x * x; }

Error bad_input(std::string message) { return {ErrorCode::kBadInput, std::move(message)}; }
Error refused(std::string message) { return {ErrorCode::kNotConverged, std::move(message)}; }

/// What makes 2 sd of a normal distribution hold as much as Student's t with so many degrees of freedom does
/// (Cornish-Fisher about the 97.5 % quantile).
double student_factor(double degrees) {
  constexpr double kZ = 1.96;
  const double first = (kZ * kZ * kZ + kZ) / 4.0;
  const double second = (5.0 * std::pow(kZ, 5) + 16.0 * kZ * kZ * kZ + 3.0 * kZ) / 96.0;
  const double third = (3.0 * std::pow(kZ, 7) + 19.0 * std::pow(kZ, 5) + 17.0 * kZ * kZ * kZ - 15.0 * kZ) / 384.0;
  return 1.0 + (first / degrees + second / square(degrees) + third / (square(degrees) * degrees)) / kZ;
}

/// Times at which the drive is cut, by the log's clock: blocks of like numbers of pieces.
std::vector<std::vector<LogPiece>> blocks_of(const std::vector<LogPiece>& pieces) {
  double all_s = 0.0;
  for (const LogPiece& piece : pieces) all_s += piece.to_s - piece.from_s;
  const auto wished = static_cast<std::size_t>(all_s / kBlockS);
  const std::size_t count = std::clamp(wished, kFewestBlocks, kMostBlocks);
  std::vector<std::vector<LogPiece>> blocks(count);
  for (std::size_t k = 0; k < pieces.size(); ++k) blocks[k * count / pieces.size()].push_back(pieces[k]);
  return blocks;
}

/// Pairs that move. The odometry decides, not the log, whose noise would choose in its own favour.
struct Moving {
  std::vector<SpeedPair> pairs;
  double slow_s = 0.0;
};

Moving moving_pairs(const std::vector<LogPiece>& pieces, const Odometer& odometer, double offset_s,
                    double least_driven_mps) {
  Moving moving;
  for (const SpeedPair& pair : pairs_at(pieces, odometer, offset_s)) {
    if (pair.driven_mps >= least_driven_mps) {
      moving.pairs.push_back(pair);
    } else {
      moving.slow_s += pair.interval_s;
    }
  }
  return moving;
}

/// All that stays the same while parts of the drive are left out.
struct Drive {
  const Odometer& odometer;
  std::vector<LogPiece> pieces;
  double least_driven_mps = 0.0;
  const ClockOffset& clock;
};

RatioFit ratio_at(const Drive& drive, double offset_s) {
  return fit_ratio(moving_pairs(drive.pieces, drive.odometer, offset_s, drive.least_driven_mps).pairs,
                   drive.clock.noise);
}

struct Spread {
  double ratio = 0.0;
  double offset_s = 0.0;
};

/// Jackknife: sd from the estimates that leave a block out each.
Spread left_out_spread(const Drive& drive, const std::vector<std::vector<LogPiece>>& blocks) {
  std::vector<Spread> estimates;
  for (std::size_t out = 0; out < blocks.size(); ++out) {
    std::vector<LogPiece> rest;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      if (k != out) rest.insert(rest.end(), blocks[k].begin(), blocks[k].end());
    }
    double offset_s = drive.clock.offset_s;
    if (drive.clock.found && !drive.clock.given) {
      offset_s = refine_clock_offset(rest, drive.odometer, drive.clock.noise, offset_s);
    }
    const auto pairs = moving_pairs(rest, drive.odometer, offset_s, drive.least_driven_mps).pairs;
    if (!pairs.empty()) estimates.push_back({fit_ratio(pairs, drive.clock.noise).ratio, offset_s});
  }
  const auto count = static_cast<double>(estimates.size());
  Spread mean, sum;
  for (const Spread& e : estimates) {
    mean.ratio += e.ratio / count;
    mean.offset_s += e.offset_s / count;
  }
  for (const Spread& e : estimates) {
    sum.ratio += square(e.ratio - mean.ratio);
    sum.offset_s += square(e.offset_s - mean.offset_s);
  }
  const double factor = student_factor(count - 1.0);
  return {factor * std::sqrt((count - 1.0) / count * sum.ratio),
          factor * std::sqrt((count - 1.0) / count * sum.offset_s)};
}

std::vector<BlockRatio> block_ratios(const Drive& drive, const std::vector<std::vector<LogPiece>>& blocks) {
  constexpr double kLeastS = 2.5;
  std::vector<BlockRatio> ratios;
  for (const std::vector<LogPiece>& block : blocks) {
    const auto pairs = moving_pairs(block, drive.odometer, drive.clock.offset_s, drive.least_driven_mps).pairs;
    if (duration_of(pairs) < kLeastS) continue;
    const RatioFit fit = fit_ratio(pairs, drive.clock.noise);
    ratios.push_back({pairs.front().time_s - 0.5 * pairs.front().interval_s,
                      pairs.back().time_s + 0.5 * pairs.back().interval_s, fit.ratio,
                      std::sqrt(kPairsAPair) * fit.formal_sd});
  }
  return ratios;
}

/// Sd between blocks that their own sd doesn't explain (DerSimonian and Laird 1986), relative.
double scatter_of(const std::vector<BlockRatio>& blocks, double ratio) {
  double weights = 0.0, squares = 0.0, weighted = 0.0;
  for (const BlockRatio& block : blocks) weights += 1.0 / square(block.sd);
  if (blocks.size() < 2) return 0.0;
  double mean = 0.0;
  for (const BlockRatio& block : blocks) mean += block.ratio / square(block.sd) / weights;
  for (const BlockRatio& block : blocks) {
    squares += 1.0 / square(square(block.sd));
    weighted += square((block.ratio - mean) / block.sd);
  }
  const double excess = weighted - static_cast<double>(blocks.size() - 1);
  return std::sqrt(std::max(0.0, excess / (weights - squares / weights))) / ratio;
}

/// What the ratio says of the log's unit.
Result<void> check_unit(double ratio, const StartHeight& start) {
  const double height_m = ratio * start.height_m;
  constexpr double kHighM = 4.0;
  constexpr double kLowM = 0.2;
  if (start.known) {
    const SpeedUnit* nearest = likely_unit(ratio);
    if (nearest == nullptr) return {};
    return bad_input(
        fmt::format("the log's speeds are {:.2f} times those of the drive at a camera height of {:g} m: in m/s "
                    "the camera would be {:.2f} m high; are they in {}? Then it is {:.2f} m",
                    ratio, start.height_m, height_m, nearest->name, height_m / nearest->per_mps));
  }
  if (height_m > kHighM) {
    return bad_input(
        fmt::format("with these speeds the camera would be {:.2f} m high: are they in km/h? Then it is {:.2f} m; "
                    "if they are in m/s, --camera-height with a rough height says so",
                    height_m, height_m / 3.6));
  }
  if (height_m < kLowM) {
    return bad_input(
        fmt::format("with these speeds the camera would be {:.3f} m high: are they in m/s, and of this drive? "
                    "If so, --camera-height with a rough height says it",
                    height_m));
  }
  return {};
}

Error stands_still(const char* what, double min_speed_mps) {
  return bad_input(
      fmt::format("{} stands still or creeps throughout: 10 s above {:g} m/s are needed", what, min_speed_mps));
}

/// Whether blocks agree, and the height is certain enough to be one.
Result<void> check_trust(const SpeedHeight& found, const HeightOptions& options) {
  if (found.scatter > options.max_scatter) {
    const auto [low, high] =
        std::minmax_element(found.blocks.begin(), found.blocks.end(),
                            [](const BlockRatio& a, const BlockRatio& b) { return a.ratio < b.ratio; });
    return refused(
        fmt::format("the ratio of the log's speeds to the drive's isn't one number: {} blocks of the drive differ by "
                    "{:.1f} % (sd) more "
                    "than noise explains, from {:.3f} ({:.0f} to {:.0f} s) to {:.3f} ({:.0f} to {:.0f} s). Is the log "
                    "of this drive, and "
                    "the clocks' offset of {:.2f} s right?",
                    found.blocks.size(), 100.0 * found.scatter, low->ratio, low->from_s, low->to_s, high->ratio,
                    high->from_s, high->to_s, found.clock.offset_s));
  }
  const double relative = found.height.height_sd_m / found.height.height_m;
  if (relative > options.max_sd) {
    return refused(fmt::format("the height would be {:.2f} m with a standard deviation of {:.0f} %: {}",
                               found.height.height_m, 100.0 * relative,
                               found.clock.found ? "a longer drive is needed"
                                                 : "the speed varies too little to find the clocks' offset, --offset S "
                                                   "would help"));
  }
  return {};
}

HeightEstimate estimate_of(double ratio, double ratio_sd, const StartHeight& start, const HeightOptions& options) {
  HeightEstimate estimate{.height_m = ratio * start.height_m, .ratio = ratio, .ratio_sd = ratio_sd};
  estimate.height_sd_m = estimate.height_m * std::hypot(ratio_sd / ratio, options.model_sd);
  return estimate;
}

}  // namespace

Result<void> check_moving(const SpeedLog& log, const HeightOptions& options) {
  constexpr double kLeastS = 10.0;
  double moving_s = 0.0;
  for (const LogPiece& piece : pieces_of(log)) {
    const double interval_s = piece.to_s - piece.from_s;
    if (piece.way_m > options.min_speed_mps * interval_s) moving_s += interval_s;
  }
  if (moving_s < kLeastS) return stands_still("the log", options.min_speed_mps);
  return {};
}

Result<SpeedHeight> height_from_speed(const SpeedLog& log, const Odometer& odometer, const StartHeight& start,
                                      const ClockSearch& search, const HeightOptions& options) {
  if (const auto moves = check_moving(log, options); !moves) return moves.error();
  constexpr double kStandingMps = 0.1;  // at the start's height, whatever that is
  if (odometer.length_m() < kStandingMps * (odometer.last_s() - odometer.first_s())) {
    return stands_still("the camera", options.min_speed_mps);
  }
  SpeedHeight found;
  auto clock = find_clock_offset(log, odometer, search);
  if (!clock) return clock.error();
  found.clock = std::move(*clock);
  Drive drive{.odometer = odometer, .pieces = pieces_of(log), .clock = found.clock};
  const auto shared = pairs_at(drive.pieces, odometer, found.clock.offset_s);
  const double first_ratio = fit_ratio(shared, found.clock.noise).ratio;
  drive.least_driven_mps = options.min_speed_mps / first_ratio;
  const Moving moving = moving_pairs(drive.pieces, odometer, found.clock.offset_s, drive.least_driven_mps);
  found.compared_s = duration_of(moving.pairs);
  found.slow_s = moving.slow_s;
  constexpr double kLeastS = 10.0;
  if (found.compared_s < kLeastS) return stands_still("what log and video have in common", options.min_speed_mps);
  const RatioFit fit = fit_ratio(moving.pairs, found.clock.noise);
  if (const auto unit = check_unit(fit.ratio, start); !unit) return unit.error();
  for (const SpeedPair& pair : moving.pairs) found.mean_speed_mps += pair.log_mps * pair.interval_s / found.compared_s;

  // Only what is shared is cut into blocks.
  std::erase_if(drive.pieces, [&](const LogPiece& piece) {
    return !odometer.distance_m(piece.from_s - found.clock.offset_s, piece.to_s - found.clock.offset_s);
  });
  const auto blocks = blocks_of(drive.pieces);
  const Spread spread = left_out_spread(drive, blocks);
  double variance = square(std::max(spread.ratio, fit.formal_sd));
  drive.pieces = pieces_of(log);
  for (const ClockOffset::Candidate& candidate : found.clock.candidates) {
    variance += candidate.weight * square(ratio_at(drive, candidate.offset_s).ratio - fit.ratio);
  }
  found.offset_sd_s = found.clock.given ? 0.0 : std::max(found.clock.sd_s, found.clock.found ? spread.offset_s : 0.0);
  found.blocks = block_ratios(drive, blocks);
  found.scatter = scatter_of(found.blocks, fit.ratio);
  found.height = estimate_of(fit.ratio, std::sqrt(variance), start, options);
  if (const auto trusted = check_trust(found, options); !trusted) return trusted.error();
  return found;
}

namespace {

/// Relative sd of the road's measurement over frames first + 1 to last, from blocks of it.
double road_sd(const std::vector<FrameResult>& results, double from_s, double to_s) {
  constexpr double kUnknown = 0.01;  // with fewer than three blocks
  struct Block {
    double sum = 0.0;
    int count = 0;
  };
  std::vector<Block> blocks(static_cast<std::size_t>((to_s - from_s) / kBlockS) + 1);
  for (const FrameResult& result : results) {
    if (!result.accepted() || result.step_m <= 0.0 || result.time_s < from_s || result.time_s > to_s) continue;
    Block& block = blocks[static_cast<std::size_t>((result.time_s - from_s) / kBlockS)];
    block.sum += std::log(*result.raw_over_online * result.online_step_m / result.step_m);
    ++block.count;
  }
  std::vector<double> means;
  for (const Block& block : blocks) {
    if (block.count > 0) means.push_back(block.sum / block.count);
  }
  if (means.size() < 3) return kUnknown;
  const auto count = static_cast<double>(means.size());
  double mean = 0.0, sum = 0.0;
  for (const double m : means) mean += m / count;
  for (const double m : means) sum += square(m - mean);
  return student_factor(count - 1.0) * std::sqrt(sum / (count - 1.0) / count);
}

}  // namespace

Result<HeightEstimate> height_from_distance(const KnownDistance& known, const std::vector<FrameResult>& results,
                                            const StartHeight& start, const HeightOptions& options) {
  GS_CHECK(known.distance_m > 0.0 && known.distance_sd_m >= 0.0, "a distance above 0");
  const Odometer odometer(results);
  const double from_s = known.from_s.value_or(odometer.first_s());
  const double to_s = known.to_s.value_or(odometer.last_s());
  if (from_s < odometer.first_s() || to_s > odometer.last_s() || !(from_s < to_s)) {
    return bad_input(fmt::format("the distance is from {:g} to {:g} s, but the video goes from {:g} to {:g} s", from_s,
                                 to_s, odometer.first_s(), odometer.last_s()));
  }
  const std::optional<double> driven_m = odometer.distance_m(from_s, to_s);
  if (!driven_m) {
    return refused(fmt::format("{:.1f} s of the way between {:g} and {:g} s had to be bridged: its length isn't known",
                               odometer.unknown_s(from_s, to_s), from_s, to_s));
  }
  constexpr double kLeastM = 2.0;
  if (*driven_m < kLeastM) {
    return bad_input(
        fmt::format("the camera goes {:.2f} m between {:g} and {:g} s (at a height of {:g} m): too little to "
                    "compare with",
                    *driven_m, from_s, to_s, start.height_m));
  }
  const double ratio = known.distance_m / *driven_m;
  if (const auto unit = check_unit(ratio, start); !unit) {
    return bad_input(
        fmt::format("the way between {:g} and {:g} s is {:.1f} m long at a camera height of {:g} m; with {:g} m "
                    "the camera would be {:.2f} m high: is the distance in metres, and that between these "
                    "times?",
                    from_s, to_s, *driven_m, start.height_m, known.distance_m, ratio * start.height_m));
  }
  const double speed_mps = *driven_m / (to_s - from_s);
  const double timing = speed_mps * odometer.median_interval_s() / *driven_m / std::sqrt(6.0);  // both ends
  const double sd = std::hypot(known.distance_sd_m / known.distance_m, timing, road_sd(results, from_s, to_s));
  const HeightEstimate estimate = estimate_of(ratio, ratio * sd, start, options);
  if (estimate.height_sd_m > options.max_sd * estimate.height_m) {
    return refused(
        fmt::format("the height would be {:.2f} m with a standard deviation of {:.0f} %: a longer way is needed",
                    estimate.height_m, 100.0 * estimate.height_sd_m / estimate.height_m));
  }
  return estimate;
}

}  // namespace groundscale
