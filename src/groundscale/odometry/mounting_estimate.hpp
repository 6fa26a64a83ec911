#pragma once

#include <optional>

#include "groundscale/camera/mounting.hpp"

namespace groundscale {

/// How much a measurement says about the mounting, 0 to 1: less in a turn, and less where it is uncertain.
/// @param log_sd  Of the measured step or scale.
double mounting_weight(double curvature_per_m, double log_sd);

/// The mounting angles: from the camera file, or found in the first accepted measurements and refined slowly.
class MountingEstimate {
 public:
  /// @param settle_after  Sum of weights after which a mounting that the file leaves open counts as found.
  MountingEstimate(std::optional<double> pitch_rad, std::optional<double> roll_rad, std::optional<double> yaw_rad,
                   int settle_after);

  /// @param weight  0 to 1: 1 for a precise measurement on a straight, little for one in a tight turn, where the strip
  ///                reaches kerbs and pavements.
  void accept(double pitch_rad, double roll_rad, double weight);
  bool settled() const { return given_ || weights_ >= settle_after_; }
  /// Mounting for the gate: the file's or the one found.
  Mounting mounting() const { return mounting_; }
  /// Running mean of accepted normals.
  Eigen::Vector3d mean_normal() const { return Mounting{mean_pitch_rad_, mean_roll_rad_, 0.0}.normal_in_cam(); }

 private:
  bool given_;
  double settle_after_;
  double weights_ = 0.0;
  Mounting mounting_;
  double mean_pitch_rad_, mean_roll_rad_;
};

}  // namespace groundscale
