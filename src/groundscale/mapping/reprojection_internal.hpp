#pragma once

#include <cmath>
#include <optional>

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {

/// Pixel of a point of the world, with derivatives. by_pose is of the perturbation (w, u): R <- exp(w) R, t <- t + u.
struct Reprojection {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> by_point;
  Eigen::Matrix<double, 2, 6> by_pose;
};

/// project(R X + t); nothing where the camera's model isn't valid.
inline std::optional<Reprojection> reproject(const Camera& camera, const RigidTransform& cam_from_world,
                                             const Eigen::Vector3d& point_in_world) {
  const Eigen::Vector3d turned = cam_from_world.rotation * point_in_world;
  Eigen::Matrix<double, 2, 3> by_ray;
  const auto pixel = camera.project(turned + cam_from_world.translation, &by_ray);
  if (!pixel) return std::nullopt;
  Reprojection result;
  result.pixel = *pixel;
  result.by_point.noalias() = by_ray * cam_from_world.rotation;
  // g . (w x p) = w . (p x g), written out: a cross product of a row needs Eigen's geometry module in every file.
  for (int k = 0; k < 2; ++k) {
    result.by_pose(k, 0) = turned.y() * by_ray(k, 2) - turned.z() * by_ray(k, 1);
    result.by_pose(k, 1) = turned.z() * by_ray(k, 0) - turned.x() * by_ray(k, 2);
    result.by_pose(k, 2) = turned.x() * by_ray(k, 1) - turned.y() * by_ray(k, 0);
  }
  result.by_pose.rightCols<3>() = by_ray;
  return result;
}

/// J with exp(w + d) = exp(J d) exp(w) to first order; for |w| below a whole turn.
inline Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& w) {
  const double angle2 = w.squaredNorm();
  const Eigen::Matrix3d cross = skew(w);
  constexpr double kSmall2 = 1e-6;  // the next terms of the series are below 1e-14
  if (angle2 < kSmall2) {
    return Eigen::Matrix3d::Identity() + (0.5 - angle2 / 24.0) * cross + (1.0 / 6.0 - angle2 / 120.0) * cross * cross;
  }
  const double angle = std::sqrt(angle2);
  return Eigen::Matrix3d::Identity() + ((1.0 - std::cos(angle)) / angle2) * cross +
         ((angle - std::sin(angle)) / (angle2 * angle)) * cross * cross;
}

}  // namespace groundscale
