#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "groundscale/geometry/rigid_transform.hpp"

namespace groundscale {

/// cam_from_world of three points seen along three unit rays, up to four. OpenGV's solver after Kneip, Scaramuzza,
/// Siegwart 2011. None where the points lie on a line.
std::vector<RigidTransform> three_point_poses(const std::array<Eigen::Vector3d, 3>& points_in_world,
                                              const std::array<Eigen::Vector3d, 3>& rays);

}  // namespace groundscale
