#include "groundscale/estimation/kalman.hpp"

#include <cmath>

namespace groundscale {

double GaussMarkov::decay(double dt_s) const { return std::exp(-dt_s / correlation_time_s); }

double GaussMarkov::noise_variance(double dt_s) const {
  return -sigma * sigma * std::expm1(-2.0 * dt_s / correlation_time_s);
}

}  // namespace groundscale
