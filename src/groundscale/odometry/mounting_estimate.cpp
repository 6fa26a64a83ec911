#include "groundscale/odometry/mounting_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace groundscale {

double mounting_weight(double curvature_per_m, double log_sd) {
  constexpr double kStraightPerM = 0.02;  // a radius of 50 m counts half
  constexpr double kPreciseSd = 0.03;
  const double turn = curvature_per_m / kStraightPerM;
  return std::min(1.0, std::pow(kPreciseSd / log_sd, 2)) / (1.0 + turn * turn);
}

MountingEstimate::MountingEstimate(std::optional<double> pitch_rad, std::optional<double> roll_rad,
                                   std::optional<double> yaw_rad, int settle_after)
    : given_(pitch_rad.has_value() && roll_rad.has_value()),
      settle_after_(settle_after),
      mounting_{pitch_rad.value_or(0.0), roll_rad.value_or(0.0), yaw_rad.value_or(0.0)},
      mean_pitch_rad_(mounting_.pitch_rad),
      mean_roll_rad_(mounting_.roll_rad) {}

void MountingEstimate::accept(double pitch_rad, double roll_rad, double weight) {
  // Plain means first, then the mean follows a drive's slope within some 50 measurements, the mounting within some 500.
  constexpr double kMeanMemory = 50.0;
  constexpr double kMountingMemory = 500.0;
  // What is known before the first one, the file's angles or a level camera, is worth one measurement.
  weights_ += weight;
  const double mean_gain = weight / std::min(kMeanMemory, 1.0 + weights_);
  mean_pitch_rad_ += mean_gain * (pitch_rad - mean_pitch_rad_);
  mean_roll_rad_ += mean_gain * (roll_rad - mean_roll_rad_);
  if (given_) return;
  const double mounting_gain = weight / std::min(kMountingMemory, 1.0 + weights_);
  mounting_.pitch_rad += mounting_gain * (pitch_rad - mounting_.pitch_rad);
  mounting_.roll_rad += mounting_gain * (roll_rad - mounting_.roll_rad);
}

}  // namespace groundscale
