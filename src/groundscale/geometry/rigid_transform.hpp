#pragma once

#include <Eigen/Core>

namespace groundscale {

/// A rotation and a translation, target_from_source: X_target = rotation X_source + translation.
///
/// rotation is in SO(3); nothing here re-orthonormalises it silently, use `nearest_rotation` after long chains.
struct RigidTransform {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return rotation * point + translation; }
  RigidTransform operator*(const RigidTransform& other) const {
    return {rotation * other.rotation, rotation * other.translation + translation};
  }
  RigidTransform inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }
};

}  // namespace groundscale
