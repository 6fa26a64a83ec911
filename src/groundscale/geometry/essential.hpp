#pragma once

#include <Eigen/Core>

#include "groundscale/geometry/rigid_transform.hpp"

namespace groundscale {

/// E = [t]x R: cam2_ray . E cam1_ray = 0 for every point seen in both views.
Eigen::Matrix3d essential_matrix(const RigidTransform& cam2_from_cam1);

/// Angle, to first order, by which two unit rays miss each other's epipolar planes together (Sampson's distance on the
/// sphere): ray2 . E ray1 / sqrt(|E ray1|^2 + |E^T ray2|^2). Signed, rad.
double epipolar_error_rad(const Eigen::Matrix3d& essential, const Eigen::Vector3d& ray1, const Eigen::Vector3d& ray2);

/// Depths along two unit rays of the point nearest to both: d2 ray2 = d1 R ray1 + t in the least-squares sense.
/// Negative where the rays meet behind the cameras; infinite where they are parallel.
struct RayDepths {
  double along_ray1 = 0.0;
  double along_ray2 = 0.0;
};
RayDepths triangulate_depths(const RigidTransform& cam2_from_cam1, const Eigen::Vector3d& ray1,
                             const Eigen::Vector3d& ray2);

}  // namespace groundscale
