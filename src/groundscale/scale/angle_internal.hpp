#pragma once

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace groundscale {

/// Between two directions, accurate near 0.
inline double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

}  // namespace groundscale
