#pragma once

#include <cmath>
#include <vector>

namespace groundscale {

/// Huber's loss: r^2 / 2 up to `bound`, then bound (r - bound / 2).
struct HuberLoss {
  double bound = 1.0;
  double rho(double r) const { return std::abs(r) <= bound ? 0.5 * r * r : bound * (std::abs(r) - 0.5 * bound); }
  /// rho'(r) / r, the weight of r^2 in iteratively reweighted least squares.
  double weight(double r) const { return std::abs(r) <= bound ? 1.0 : bound / std::abs(r); }
};

/// Cauchy's loss: bound^2 / 2 log(1 + (r / bound)^2). Redescending: gross outliers lose all influence.
struct CauchyLoss {
  double bound = 1.0;
  double rho(double r) const { return 0.5 * bound * bound * std::log1p(r * r / (bound * bound)); }
  double weight(double r) const { return 1.0 / (1.0 + r * r / (bound * bound)); }
};

/// The value at `fraction` (0..1) of the sorted values, without interpolation; NaN where there are none.
double quantile(std::vector<double> values, double fraction);

/// The middle value, mean of the middle two for an even count; NaN where there are none.
double median(std::vector<double> values);

}  // namespace groundscale
