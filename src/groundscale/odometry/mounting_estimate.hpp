#pragma once

#include <optional>
#include <vector>

#include "groundscale/camera/mounting.hpp"

namespace groundscale {

/// The mounting angles: from the camera file, or found in the first accepted measurements and refined slowly.
class MountingEstimate {
 public:
  /// @param settle_after  Accepted measurements after which a mounting that the file leaves open counts as found.
  MountingEstimate(std::optional<double> pitch_rad, std::optional<double> roll_rad, std::optional<double> yaw_rad,
                   int settle_after);

  void accept(double pitch_rad, double roll_rad);
  bool settled() const { return given_ || accepted_ >= settle_after_; }
  /// Mounting for the gate: the file's or the one found.
  Mounting mounting() const { return mounting_; }
  /// Running mean of accepted normals.
  Eigen::Vector3d mean_normal() const { return Mounting{mean_pitch_rad_, mean_roll_rad_, 0.0}.normal_in_cam(); }

 private:
  bool given_;
  int settle_after_;
  int accepted_ = 0;
  Mounting mounting_;
  double mean_pitch_rad_, mean_roll_rad_;
  std::vector<double> first_pitches_, first_rolls_;
};

}  // namespace groundscale
