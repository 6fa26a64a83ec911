#pragma once

#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "groundscale/geometry/trajectory.hpp"

namespace groundscale::internal {

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// For tests: a drive on a level road, from yaw (right is positive) and length of each step.
inline Trajectory drive_of(const std::vector<double>& yaws_deg, const std::vector<double>& steps_m) {
  Trajectory drive;
  RigidTransform pose;
  drive.world_from_cam.push_back(pose);
  for (std::size_t k = 0; k < steps_m.size(); ++k) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(yaws_deg[k] * kRadPerDeg, Eigen::Vector3d::UnitY()).toRotationMatrix();
    pose = pose * RigidTransform{turn, {0.0, 0.0, steps_m[k]}};
    drive.world_from_cam.push_back(pose);
  }
  return drive;
}

/// Straight ahead in steps of one length.
inline Trajectory straight_drive(int rows, double step_m) {
  const std::size_t steps = static_cast<std::size_t>(rows) - 1;
  return drive_of(std::vector<double>(steps, 0.0), std::vector<double>(steps, step_m));
}

/// Gives a drive evenly spaced times.
inline Trajectory with_times(Trajectory drive, double interval_s) {
  for (int row = 0; row < drive.size(); ++row) drive.times_s.push_back(interval_s * row);
  return drive;
}

/// Every position times a factor: the same drive seen with a wrong scale.
inline Trajectory stretched(Trajectory drive, double factor) {
  for (RigidTransform& pose : drive.world_from_cam) pose.translation *= factor;
  return drive;
}

}  // namespace groundscale::internal
