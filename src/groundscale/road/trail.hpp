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

  /// Centres of past cameras: from the present one backwards, each the first that is at least `spacing_m` from the one
  /// before it; their polyline is at most `length_m` long. None while the camera stood.
  std::vector<Eigen::Vector3d> centres(double spacing_m, double length_m) const;
};

/// The latest part of a trajectory as a trail.
/// @param world_from_cam   The present camera last, in any unit; empty or one pose: an empty trail.
/// @param metres_per_unit  Of that unit.
/// @param length_m         How far back the trail goes: its last pose is the first one that is as far back as that.
Trail trail_of(const std::vector<RigidTransform>& world_from_cam, double metres_per_unit, double length_m);

struct PathAheadOptions {
  double heading_m = 3.0;      ///< Chord and turn are those of the way behind, over so much of it.
  double steady_m = 6.0;       ///< Within such a way drivers change the curvature by as much as itself; 0: never.
  double max_turn_deg = 20.0;  ///< The path turns by so much, and goes straight on from there.
};

void visit_fields(PathAheadOptions& options, FieldVisitor& visitor);

/// Path at the present camera: chord and turn over the last heading_m that it drove (path_of_motion), over less where
/// it has driven less, and straight along the mounting's forward direction where that is below 5 cm.
DrivenPath path_of_trail(const Trail& trail, const PathAheadOptions& options, const Eigen::Vector3d& normal_in_cam,
                         const Eigen::Vector3d& mounting_forward_in_cam);

struct PathWeightOptions {
  double behind_m = 4.0;      ///< Points are weighed by the last part of the trail, so long,
  double ahead_m = 10.0;      ///< and count up to this distance ahead,
  double half_width_m = 2.5;  ///< no farther than this from the path or trail,
  double weight_sd_m = 1.0;   ///< by exp(-u^2 / (2 sd^2)), u that distance: roads fall off to their sides.
};

void visit_fields(PathWeightOptions& options, FieldVisitor& visitor);

/// How much a point of the road says about the plane beneath the vehicle: w = exp(-u^2 / (2 sd^2)), 0 beyond the path's
/// surroundings. Ahead u is the distance to the path's arc, behind to the polyline of the trail's last `behind_m`, both
/// along the road: the point's own height doesn't count. Without a trail what lies behind has no weight.
/// Where the vehicle is going isn't known but to p = DrivenPath::sd_m: ahead w is the mean of the above over paths,
/// w = sd / q exp(-u^2 / (2 q^2)), q^2 = sd^2 + p^2, and half_width_m grows by q / sd.
/// @param point_in_cam_m  In metres, as the trail and the road are.
double path_weight(const Eigen::Vector3d& point_in_cam_m, const Trail& trail, const DrivenPath& path,
                   const GroundPlane& metric_road, const PathWeightOptions& options);

}  // namespace groundscale
