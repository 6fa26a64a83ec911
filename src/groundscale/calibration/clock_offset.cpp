#include "groundscale/calibration/clock_offset.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "groundscale/core/check.hpp"

namespace groundscale {
namespace {

constexpr double kStepS = 0.2;  // of the first search; speeds vary over a second and more
constexpr double kFineStepS = 0.05;
constexpr int kFineSteps = 12;  // to both sides, 0.6 s
constexpr double kLeastSharedS = 10.0;
constexpr double kLeastShare = 0.5;
constexpr double kFoundSdS = 1.0;
/// Neighbouring pairs share a sample of the log, and the odometry's errors last: a pair counts as half a one.
constexpr double kPairsAPair = 2.0;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double cost_at(const std::vector<LogPiece>& pieces, const Odometer& odometer, const SpeedNoise& noise,
               double offset_s) {
  const std::vector<SpeedPair> pairs = pairs_at(pieces, odometer, offset_s);
  return pairs.empty() ? kInfinity : fit_ratio(pairs, noise).cost;
}

struct Range {
  double from_s = 0.0;
  double to_s = 0.0;
  bool aligned = false;
};

Result<Range> range_of(const SpeedLog& log, const Odometer& odometer, const ClockSearch& search) {
  const auto reaches = [&](double centre_s) {
    return log.last_s() - centre_s + search.max_offset_s > odometer.first_s() &&
           log.first_s() - centre_s - search.max_offset_s < odometer.last_s();
  };
  const double reach_s = search.max_offset_s;
  if (reaches(0.0)) return Range{-reach_s, reach_s};
  constexpr double kAnotherClockS = 3600.0;
  const double apart_s = std::max(odometer.first_s() - log.last_s(), log.first_s() - odometer.last_s());
  const double start_s = log.first_s() - search.video_start_s;
  if (apart_s > kAnotherClockS && reaches(start_s)) return Range{start_s - reach_s, start_s + reach_s, true};
  return Error{
      ErrorCode::kBadInput,
      fmt::format("the log doesn't overlap the video: it goes from {:.1f} to {:.1f} s, the video from {:.1f} to "
                  "{:.1f} s, and clocks may differ by {:g} s (--max-offset); --offset says by how much they do",
                  log.first_s(), log.last_s(), odometer.first_s(), odometer.last_s(), reach_s)};
}

/// What was looked at.
struct Trial {
  double offset_s = 0.0;
  double shared_s = 0.0;
  double cost = kInfinity;
  double pairs = 0.0;
};

void rate(std::vector<Trial>& trials, const std::vector<LogPiece>& pieces, const Odometer& odometer,
          const SpeedNoise& noise) {
  double most_s = 0.0;
  for (const Trial& trial : trials) most_s = std::max(most_s, trial.shared_s);
  for (Trial& trial : trials) {
    if (trial.shared_s < std::max(kLeastSharedS, kLeastShare * most_s)) continue;
    trial.cost = cost_at(pieces, odometer, noise, trial.offset_s);
  }
}

const Trial& best_of(const std::vector<Trial>& trials) {
  return *std::min_element(trials.begin(), trials.end(),
                           [](const Trial& a, const Trial& b) { return a.cost < b.cost; });
}

Error too_little(double shared_s) {
  return {ErrorCode::kBadInput,
          fmt::format(
              "log and video have {:.0f} s in common at most (gaps of the log and stretches that the odometry had to "
              "bridge don't count), at least {:.0f} s are needed",
              shared_s, kLeastSharedS)};
}

/// Weights by exp(-chi^2 / 2) above the least; those that don't count are left out.
void weigh(const std::vector<Trial>& trials, const Trial& best, ClockOffset& offset) {
  double sum = 0.0, mean_s = 0.0, square_s2 = 0.0;
  for (const Trial& trial : trials) {
    if (trial.cost == kInfinity) continue;
    const double excess = (trial.cost - best.cost) * best.pairs / (kPairsAPair * std::max(1.0, best.cost));
    const double weight = std::exp(-0.5 * excess);
    constexpr double kLeastWeight = 1e-3;
    if (weight < kLeastWeight) continue;
    offset.candidates.push_back({trial.offset_s, weight});
    sum += weight;
    mean_s += weight * (trial.offset_s - best.offset_s);
    square_s2 += weight * std::pow(trial.offset_s - best.offset_s, 2);
  }
  for (ClockOffset::Candidate& candidate : offset.candidates) candidate.weight /= sum;
  offset.sd_s = std::sqrt(std::max(0.0, square_s2 / sum - std::pow(mean_s / sum, 2)));
}

Result<ClockOffset> given_offset(const std::vector<LogPiece>& pieces, const Odometer& odometer, double offset_s) {
  const std::vector<SpeedPair> pairs = pairs_at(pieces, odometer, offset_s);
  if (duration_of(pairs) < kLeastSharedS) return too_little(duration_of(pairs));
  ClockOffset offset{.offset_s = offset_s, .given = true, .found = true, .candidates = {{offset_s}}};
  offset.noise.log_mps = noise_about(pairs, fit_ratio(pairs, offset.noise).ratio);
  return offset;
}

}  // namespace

double refine_clock_offset(const std::vector<LogPiece>& pieces, const Odometer& odometer, const SpeedNoise& noise,
                           double near_s) {
  std::vector<double> costs;
  for (int k = -kFineSteps; k <= kFineSteps; ++k)
    costs.push_back(cost_at(pieces, odometer, noise, near_s + k * kFineStepS));
  const auto best = static_cast<int>(std::min_element(costs.begin(), costs.end()) - costs.begin());
  double part = 0.0;
  if (best > 0 && best + 1 < static_cast<int>(costs.size())) {
    const auto at = static_cast<std::size_t>(best);
    const double curvature = costs[at - 1] - 2.0 * costs[at] + costs[at + 1];
    if (std::isfinite(curvature) && curvature > 0.0) part = 0.5 * (costs[at - 1] - costs[at + 1]) / curvature;
  }
  return near_s + (best - kFineSteps + part) * kFineStepS;
}

Result<ClockOffset> find_clock_offset(const SpeedLog& log, const Odometer& odometer, const ClockSearch& search) {
  const std::vector<LogPiece> pieces = pieces_of(log);
  if (search.offset_s) return given_offset(pieces, odometer, *search.offset_s);
  const Result<Range> range = range_of(log, odometer, search);
  if (!range) return range.error();
  std::vector<Trial> trials;
  const int steps = static_cast<int>(std::floor((range->to_s - range->from_s) / kStepS + 0.5));
  for (int k = 0; k <= steps; ++k) {
    const double offset_s = range->from_s + k * kStepS;
    const std::vector<SpeedPair> pairs = pairs_at(pieces, odometer, offset_s);
    trials.push_back(
        {.offset_s = offset_s, .shared_s = duration_of(pairs), .pairs = static_cast<double>(pairs.size())});
  }
  ClockOffset offset{.aligned = range->aligned};
  // First with a noise that is likely, then with the one that is left at the best offset.
  for (int pass = 0; pass < 2; ++pass) {
    rate(trials, pieces, odometer, offset.noise);
    if (best_of(trials).cost == kInfinity) {
      double most_s = 0.0;
      for (const Trial& trial : trials) most_s = std::max(most_s, trial.shared_s);
      return too_little(most_s);
    }
    offset.offset_s = refine_clock_offset(pieces, odometer, offset.noise, best_of(trials).offset_s);
    const std::vector<SpeedPair> pairs = pairs_at(pieces, odometer, offset.offset_s);
    offset.noise.log_mps = noise_about(pairs, fit_ratio(pairs, offset.noise).ratio);
  }
  const Trial best = best_of(trials);
  weigh(trials, best, offset);
  offset.found = offset.sd_s < kFoundSdS;
  if (offset.found) offset.candidates = {{offset.offset_s}};
  const bool at_end = std::min(best.offset_s - range->from_s, range->to_s - best.offset_s) < 0.5 * kStepS;
  if (offset.found && at_end && steps > 0) {
    return Error{
        ErrorCode::kNotConverged,
        fmt::format("log and odometry agree best at the end of the range in which the clocks' offset was looked "
                    "for, {:.1f} s: --max-offset {:g} looks further",
                    best.offset_s, 4.0 * search.max_offset_s)};
  }
  return offset;
}

}  // namespace groundscale
