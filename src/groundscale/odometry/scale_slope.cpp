#include "groundscale/odometry/scale_slope.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "groundscale/estimation/robust.hpp"

namespace groundscale {
namespace {

using Sample = ScaleSlope::Sample;

/// Measurements of the ground, those of each map apart.
std::vector<std::vector<Sample>> samples_of(const std::vector<FrameResult>& results,
                                            const std::vector<ScaleEvent>& scaled) {
  std::vector<std::vector<Sample>> maps(1);
  double distance_m = 0.0;
  auto next = scaled.begin();
  for (std::size_t k = 1; k < results.size(); ++k) {
    const FrameResult& result = results[k];
    distance_m += result.online_step_m;
    const bool is_scaled = next != scaled.end() && result.frame >= next->frame;
    if (is_scaled) ++next;
    const bool other_map = result.state != FrameState::kStill && !result.map_scale.has_value();
    if ((is_scaled || other_map) && !maps.back().empty()) maps.emplace_back();
    if (!result.accepted() || !result.drift_ratio) continue;
    maps.back().push_back({distance_m, -std::log(*result.drift_ratio * *result.map_scale), result.raw_sd});
  }
  return maps;
}

/// A weighted line y = level + slope x, x counted from the samples' middle, and what its errors need.
struct Line {
  double middle_m = 0.0;
  double level = 0.0;
  double slope = 0.0;
  double spread = 0.1;  ///< Robust sd of the errors.
  double determinant = 1.0, sum_w = 0.0, sum_x = 0.0, sum_xx = 0.0;

  double x(const Sample& sample) const { return sample.distance_m - middle_m; }
  double error(const Sample& sample) const { return sample.log_ratio - level - slope * x(sample); }
  double weight(const Sample& sample) const {
    return CauchyLoss{2.0 * spread}.weight(error(sample)) / (sample.sd * sample.sd);
  }
};

Line fit_line(const std::vector<Sample>& samples) {
  Line line;
  for (const Sample& sample : samples) line.middle_m += sample.distance_m / static_cast<double>(samples.size());
  for (int iteration = 0; iteration < 20; ++iteration) {
    line.sum_w = line.sum_x = line.sum_xx = 0.0;
    double sum_y = 0.0, sum_xy = 0.0;
    std::vector<double> deviations;
    for (const Sample& sample : samples) {
      const double x = line.x(sample);
      const double w = line.weight(sample);
      deviations.push_back(std::abs(line.error(sample)));
      line.sum_w += w;
      line.sum_x += w * x;
      line.sum_xx += w * x * x;
      sum_y += w * sample.log_ratio;
      sum_xy += w * x * sample.log_ratio;
    }
    line.determinant = line.sum_w * line.sum_xx - line.sum_x * line.sum_x;
    line.level = (line.sum_xx * sum_y - line.sum_x * sum_xy) / line.determinant;
    line.slope = (line.sum_w * sum_xy - line.sum_x * sum_y) / line.determinant;
    line.spread = std::max(1e-3, 1.4826 * median(std::move(deviations)));
  }
  return line;
}

/// Neighbouring measurements see the same road: their errors count together, each block's as if the line had been laid
/// without it (jackknife).
double slope_variance(const Line& line, const std::vector<Sample>& samples) {
  constexpr double kBlockM = 25.0;
  struct Block {
    double change = 0.0;
    double leverage = 0.0;
  };
  std::map<int, Block> blocks;
  for (const Sample& sample : samples) {
    const double x = line.x(sample);
    const double w = line.weight(sample);
    Block& block = blocks[static_cast<int>(sample.distance_m / kBlockM)];
    block.change += w * line.error(sample) * (line.sum_w * x - line.sum_x) / line.determinant;
    block.leverage += w * (line.sum_xx - 2.0 * line.sum_x * x + line.sum_w * x * x) / line.determinant;
  }
  double variance = 0.0;
  for (const auto& [index, block] : blocks) {
    constexpr double kMostLeverage = 0.9;
    variance += std::pow(block.change / (1.0 - std::min(kMostLeverage, block.leverage)), 2);
  }
  return variance;
}

}  // namespace

Result<ScaleSlope> fit_scale_slope(std::vector<ScaleSlope::Sample> samples) {
  constexpr std::size_t kMinSamples = 20;
  constexpr double kMinLengthM = 30.0;
  const double length_m = samples.empty() ? 0.0 : samples.back().distance_m - samples.front().distance_m;
  if (samples.size() < kMinSamples || length_m < kMinLengthM) {
    return Error{ErrorCode::kTooFewMatches,
                 fmt::format("{} measurements of the ground over {:.0f} m, {} over {:.0f} m are needed", samples.size(),
                             length_m, kMinSamples, kMinLengthM)};
  }
  const Line line = fit_line(samples);
  ScaleSlope result;
  result.per_100m = 100.0 * line.slope;
  result.sd_per_100m = 100.0 * std::sqrt(slope_variance(line, samples));
  result.length_m = length_m;
  result.measurements = static_cast<int>(samples.size());
  result.level = line.level - line.slope * line.middle_m;
  result.samples = std::move(samples);
  return result;
}

std::optional<ScaleSlope> combined_slope(std::vector<ScaleSlope> lines) {
  if (lines.empty()) return std::nullopt;
  double information = 0.0, weighted = 0.0, length_m = 0.0;
  int measurements = 0;
  std::size_t longest = 0;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    constexpr double kLeastSd = 1e-4;
    const double own = 1.0 / std::pow(std::max(kLeastSd, lines[k].sd_per_100m), 2);
    information += own;
    weighted += own * lines[k].per_100m;
    length_m += lines[k].length_m;
    measurements += lines[k].measurements;
    if (lines[k].length_m > lines[longest].length_m) longest = k;
  }
  ScaleSlope sum = std::move(lines[longest]);
  sum.per_100m = weighted / information;
  sum.sd_per_100m = 1.0 / std::sqrt(information);
  sum.length_m = length_m;
  sum.measurements = measurements;
  return sum;
}

Result<ScaleSlope> scale_slope(const std::vector<FrameResult>& results, const std::vector<ScaleEvent>& scaled) {
  std::vector<ScaleSlope> lines;
  Error failed;
  for (std::vector<Sample>& samples : samples_of(results, scaled)) {
    auto line = fit_scale_slope(std::move(samples));
    if (line) lines.push_back(std::move(*line));
    if (!line) failed = line.error();
  }
  auto sum = combined_slope(std::move(lines));
  if (!sum) return failed;
  return std::move(*sum);
}

}  // namespace groundscale
