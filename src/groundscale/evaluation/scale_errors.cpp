#include "groundscale/evaluation/scale_errors.hpp"

#include <cmath>

#include "groundscale/evaluation/statistics_internal.hpp"

namespace groundscale {

std::optional<ScaleErrors> scale_errors(const std::vector<double>& ratios) {
  if (ratios.empty()) return std::nullopt;
  const double centre = internal::median(ratios);
  if (!(centre > 0.0)) return std::nullopt;
  std::vector<double> about_centre;
  std::vector<double> about_one;
  int within = 0;
  double squared_logs = 0.0;
  for (const double ratio : ratios) {
    about_centre.push_back(std::abs(ratio / centre - 1.0));
    about_one.push_back(std::abs(ratio - 1.0));
    if (about_centre.back() < 0.1) ++within;
    squared_logs += std::log(ratio) * std::log(ratio);
  }
  const double count = static_cast<double>(ratios.size());
  ScaleErrors errors;
  errors.steps = static_cast<int>(ratios.size());
  errors.bias = centre - 1.0;
  errors.spread = internal::median(about_centre);
  errors.within_10_percent = within / count;
  errors.mean = internal::mean(about_one);
  errors.p95 = internal::percentile(about_one, 0.95);
  errors.rms_log = std::sqrt(squared_logs / count);
  return errors;
}

std::optional<ScaleDrift> scale_drift(const std::vector<RatioAt>& ratios, double from_m) {
  std::vector<double> distances_m;
  std::vector<double> logs;
  for (const RatioAt& at : ratios) {
    if (at.true_distance_m < from_m || !(at.ratio > 0.0)) continue;
    distances_m.push_back(at.true_distance_m);
    logs.push_back(std::log(at.ratio));
  }
  if (logs.size() < 2) return std::nullopt;
  const double mean_distance_m = internal::mean(distances_m);
  const double mean_log = internal::mean(logs);
  double products = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const double away_m = distances_m[i] - mean_distance_m;
    products += away_m * (logs[i] - mean_log);
    squares += away_m * away_m;
  }
  if (!(squares > 0.0)) return std::nullopt;
  return ScaleDrift{static_cast<int>(logs.size()), products / squares};
}

}  // namespace groundscale
