#include "groundscale/odometry/mounting_estimate.hpp"

#include <algorithm>

#include "groundscale/estimation/robust.hpp"

namespace groundscale {

MountingEstimate::MountingEstimate(std::optional<double> pitch_rad, std::optional<double> roll_rad,
                                   std::optional<double> yaw_rad, int settle_after)
    : given_(pitch_rad.has_value() && roll_rad.has_value()),
      settle_after_(settle_after),
      mounting_{pitch_rad.value_or(0.0), roll_rad.value_or(0.0), yaw_rad.value_or(0.0)},
      mean_pitch_rad_(mounting_.pitch_rad),
      mean_roll_rad_(mounting_.roll_rad) {}

void MountingEstimate::accept(double pitch_rad, double roll_rad) {
  ++accepted_;
  if (!settled()) {
    first_pitches_.push_back(pitch_rad);
    first_rolls_.push_back(roll_rad);
    mounting_.pitch_rad = mean_pitch_rad_ = median(first_pitches_);
    mounting_.roll_rad = mean_roll_rad_ = median(first_rolls_);
    return;
  }
  // The mean follows a drive's slope within some 50 measurements, the mounting within some 500.
  constexpr double kMeanGain = 0.02;
  constexpr double kMountingGain = 0.002;
  mean_pitch_rad_ += kMeanGain * (pitch_rad - mean_pitch_rad_);
  mean_roll_rad_ += kMeanGain * (roll_rad - mean_roll_rad_);
  if (given_) return;
  mounting_.pitch_rad += kMountingGain * (pitch_rad - mounting_.pitch_rad);
  mounting_.roll_rad += kMountingGain * (roll_rad - mounting_.roll_rad);
}

}  // namespace groundscale
