#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/motion/two_view.hpp"

namespace groundscale {

/// Essential matrices (ray2 . E ray1 = 0) of five pairs, up to ten. OpenGV's solver after Nister 2004.
std::vector<Eigen::Matrix3d> five_point_essentials(const std::array<RayPair, 5>& pairs);

/// The four motions (|t| = 1) of an essential matrix (Hartley, Zisserman, result 9.19).
std::array<RigidTransform, 4> motions_of_essential(const Eigen::Matrix3d& essential);

}  // namespace groundscale
