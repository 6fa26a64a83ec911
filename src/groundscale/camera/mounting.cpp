#include "groundscale/camera/mounting.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace groundscale {

Eigen::Vector3d Mounting::normal_in_cam() const {
  return {std::sin(roll_rad), std::cos(roll_rad) * std::cos(pitch_rad), std::cos(roll_rad) * std::sin(pitch_rad)};
}

Eigen::Vector3d Mounting::forward_in_cam() const {
  // The level camera's direction of travel, turned with the smallest rotation that takes (0, 1, 0) to the normal.
  const Eigen::Vector3d level(-std::sin(yaw_rad), 0.0, std::cos(yaw_rad));
  const Eigen::Quaterniond tilt = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), normal_in_cam());
  return tilt * level;
}

PlaneAngles plane_angles(const Eigen::Vector3d& normal_in_cam) {
  return {std::atan2(normal_in_cam.z(), normal_in_cam.y()), std::asin(std::clamp(normal_in_cam.x(), -1.0, 1.0))};
}

}  // namespace groundscale
