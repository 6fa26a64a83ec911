#include "groundscale/camera/mounting.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace groundscale {

Eigen::Vector3d Mounting::normal_in_cam() const {
  return {std::sin(roll_rad), std::cos(roll_rad) * std::cos(pitch_rad), std::cos(roll_rad) * std::sin(pitch_rad)};
}

Eigen::Vector3d Mounting::forward_in_cam() const {
  // The level camera's direction of travel, turned with the smallest rotation that takes down = (0, 1, 0) to the
  // normal: R = I + [v] + [v]^2 / (1 + c) with v = down x normal, c = down . normal.
  const Eigen::Vector3d level(-std::sin(yaw_rad), 0.0, std::cos(yaw_rad));
  const Eigen::Vector3d normal = normal_in_cam();
  constexpr double kUpsideDown = 1e-12;
  if (1.0 + normal.y() < kUpsideDown) return {-level.x(), -level.y(), level.z()};  // half a turn about the optical axis
  const Eigen::Vector3d v = Eigen::Vector3d::UnitY().cross(normal);
  const Eigen::Vector3d v_cross_level = v.cross(level);
  return level + v_cross_level + v.cross(v_cross_level) / (1.0 + normal.y());
}

PlaneAngles plane_angles(const Eigen::Vector3d& normal_in_cam) {
  return {std::atan2(normal_in_cam.z(), normal_in_cam.y()), std::asin(std::clamp(normal_in_cam.x(), -1.0, 1.0))};
}

}  // namespace groundscale
