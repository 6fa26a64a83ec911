#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/core/options.hpp"
#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/road/region.hpp"

namespace groundscale {

/// Where the camera has been, seen from the present camera, in metres: most recent first, without the present one.
struct Trail {
  std::vector<RigidTransform> cam_from_past;

  /// Centres about every `spacing_m` up to `length_m` behind.
  std::vector<Eigen::Vector3d> centres(double spacing_m, double length_m) const;
};

/// The latest part of a trajectory as a trail.
/// @param world_from_cam   The present camera last, in any unit.
/// @param metres_per_unit  Of that unit.
/// @param length_m         How far back the trail goes.
Trail trail_of(const std::vector<RigidTransform>& world_from_cam, double metres_per_unit, double length_m);

/// Path at the present camera: chord and turn over the last `heading_m` that it drove; straight along the mounting's
/// forward direction where it has not driven so far.
DrivenPath path_of_trail(const Trail& trail, double heading_m, const Eigen::Vector3d& normal_in_cam,
                         const Eigen::Vector3d& mounting_forward_in_cam);

struct PathWeightOptions {
  double behind_m = 4.0;      ///< Points driven over count up to here behind the camera,
  double ahead_m = 10.0;      ///< those ahead up to here along the path,
  double half_width_m = 2.5;  ///< and up to here beside it,
  double weight_sd_m = 1.0;   ///< by exp(-u^2 / 2 sd^2), u from the path: roads fall off to their sides.
};

void visit_fields(PathWeightOptions& options, FieldVisitor& visitor);

/// How much a point of the road says about the plane beneath the vehicle: 0 beyond the path's surroundings.
/// Ahead u is the distance to the path's arc, behind to the polyline of the trail.
double path_weight(const Eigen::Vector3d& point_in_cam_m, const Trail& trail, const DrivenPath& path,
                   const GroundPlane& metric_road, const PathWeightOptions& options);

}  // namespace groundscale
