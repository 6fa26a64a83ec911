#include "groundscale/calibration/scale_slope.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "groundscale/estimation/robust.hpp"

namespace groundscale {
namespace {

struct Sample {
  double distance_m = 0.0;
  double log_ratio = 0.0;
  double sd = 0.0;
};

std::vector<Sample> samples_of(const std::vector<FrameResult>& results) {
  std::vector<Sample> samples;
  double distance_m = 0.0;
  for (std::size_t k = 1; k < results.size(); ++k) {
    const FrameResult& result = results[k];
    distance_m += result.online_step_m;
    if (!result.accepted() || !result.drift_ratio) continue;
    samples.push_back({distance_m, -std::log(*result.drift_ratio), result.raw_sd});
  }
  return samples;
}

}  // namespace

Result<ScaleSlope> scale_slope(const std::vector<FrameResult>& results) {
  const std::vector<Sample> samples = samples_of(results);
  constexpr std::size_t kMinSamples = 20;
  constexpr double kMinLengthM = 30.0;
  const double length_m = samples.empty() ? 0.0 : samples.back().distance_m - samples.front().distance_m;
  if (samples.size() < kMinSamples || length_m < kMinLengthM) {
    return Error{ErrorCode::kTooFewMatches,
                 fmt::format("{} measurements of the ground over {:.0f} m, {} over {:.0f} m are needed", samples.size(),
                             length_m, kMinSamples, kMinLengthM)};
  }
  double middle_m = 0.0;
  for (const Sample& sample : samples) middle_m += sample.distance_m / static_cast<double>(samples.size());
  double level = 0.0;
  double slope = 0.0;
  double spread = 0.1;
  double determinant = 1.0, sum_w = 0.0, sum_x = 0.0, sum_xx = 0.0;
  for (int iteration = 0; iteration < 20; ++iteration) {
    sum_w = sum_x = sum_xx = 0.0;
    double sum_y = 0.0, sum_xy = 0.0;
    std::vector<double> deviations;
    for (const Sample& sample : samples) {
      const double x = sample.distance_m - middle_m;
      const double error = sample.log_ratio - level - slope * x;
      deviations.push_back(std::abs(error));
      const double w = CauchyLoss{2.0 * spread}.weight(error) / (sample.sd * sample.sd);
      sum_w += w;
      sum_x += w * x;
      sum_xx += w * x * x;
      sum_y += w * sample.log_ratio;
      sum_xy += w * x * sample.log_ratio;
    }
    determinant = sum_w * sum_xx - sum_x * sum_x;
    level = (sum_xx * sum_y - sum_x * sum_xy) / determinant;
    slope = (sum_w * sum_xy - sum_x * sum_y) / determinant;
    spread = std::max(1e-3, 1.4826 * median(std::move(deviations)));
  }
  // Neighbouring measurements see the same road: their errors count together, each block's as if the line had been laid
  // without it (jackknife).
  constexpr double kBlockM = 25.0;
  struct Block {
    double change = 0.0;
    double leverage = 0.0;
  };
  std::map<int, Block> blocks;
  for (const Sample& sample : samples) {
    const double x = sample.distance_m - middle_m;
    const double error = sample.log_ratio - level - slope * x;
    const double w = CauchyLoss{2.0 * spread}.weight(error) / (sample.sd * sample.sd);
    Block& block = blocks[static_cast<int>(sample.distance_m / kBlockM)];
    block.change += w * error * (sum_w * x - sum_x) / determinant;
    block.leverage += w * (sum_xx - 2.0 * sum_x * x + sum_w * x * x) / determinant;
  }
  double variance = 0.0;
  for (const auto& [index, block] : blocks) {
    constexpr double kMostLeverage = 0.9;
    variance += std::pow(block.change / (1.0 - std::min(kMostLeverage, block.leverage)), 2);
  }
  ScaleSlope result;
  result.per_100m = 100.0 * slope;
  result.sd_per_100m = 100.0 * std::sqrt(variance);
  result.length_m = length_m;
  result.measurements = static_cast<int>(samples.size());
  return result;
}

}  // namespace groundscale
