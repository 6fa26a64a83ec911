#pragma once

#include <optional>
#include <vector>

namespace groundscale {

/// How far steps are from the truth, r = estimated / true step. Fractions, not percent.
struct ScaleErrors {
  int steps = 0;
  double bias = 0.0;               ///< median(r) - 1
  double spread = 0.0;             ///< median |r / median(r) - 1|
  double within_10_percent = 0.0;  ///< share of |r / median(r) - 1| < 0.1
  double mean = 0.0;               ///< mean |r - 1|
  double p95 = 0.0;                ///< 95th percentile of |r - 1|, linear between neighbours
  double rms_log = 0.0;            ///< sqrt(mean log(r)^2); steps with r = 0 make it infinite
};

/// @param ratios  Estimated / true step; none of them negative.
/// @return Nothing where there are no steps or their median is 0 (an estimate that stands still).
std::optional<ScaleErrors> scale_errors(const std::vector<double>& ratios);

/// A step ratio at a place of the drive.
struct RatioAt {
  double true_distance_m = 0.0;
  double ratio = 1.0;
};

struct ScaleDrift {
  int steps = 0;
  double log_per_m = 0.0;  ///< Slope of log(ratio); 0.001 is 10 % per 100 m.
};

/// Least-squares slope of log(ratio) over the true distance. Steps below `from_m` are left out, as are ratios of 0,
/// whose logarithm isn't finite. Positive: the estimate's steps grow against the true ones.
/// @return Nothing for fewer than two places.
std::optional<ScaleDrift> scale_drift(const std::vector<RatioAt>& ratios, double from_m = 5.0);

}  // namespace groundscale
