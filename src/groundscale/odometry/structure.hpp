#pragma once

#include <optional>
#include <vector>

#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/motion/two_view.hpp"

namespace groundscale {

/// Points that a pair of views has triangulated, in the trajectory's world and scale.
struct StructurePoint {
  TrackId id = 0;
  Eigen::Vector3d point_in_world = Eigen::Vector3d::Zero();
};

/// Inliers of a motion as points: |t| of the pair is `distance`. Points with less than `min_parallax_px` between the
/// rays are left out; ids ascend.
std::vector<StructurePoint> triangulate_pair(const std::vector<RayPair>& pairs, const TwoViewMotion& motion,
                                             const RigidTransform& world_from_cam1, double distance, double focal_px,
                                             double min_parallax_px);

/// Length of a pair's baseline from points that an earlier pair has placed in the world.
struct StructureDistance {
  double distance = 0.0;
  double log_sd = 0.0;
  int points = 0;
};

/// distance = |X - c1| / depth, median over the points that both pairs have, depth being that along ray 1 in baselines.
/// Nothing where fewer than 15 points are common.
std::optional<StructureDistance> distance_from_structure(const std::vector<StructurePoint>& known,
                                                         const std::vector<RayPair>& pairs, const TwoViewMotion& motion,
                                                         const Eigen::Vector3d& centre1_in_world, double focal_px,
                                                         double min_parallax_px);

}  // namespace groundscale
