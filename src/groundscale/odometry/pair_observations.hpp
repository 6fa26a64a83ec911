#pragma once

#include "groundscale/camera/camera.hpp"
#include "groundscale/odometry/views.hpp"
#include "groundscale/plane/observations.hpp"
#include "groundscale/road/region.hpp"
#include "groundscale/road/road_tracker.hpp"
#include "groundscale/tracking/matches.hpp"

namespace groundscale {

/// Where a pair's road lies by what is known so far, in metres.
struct ExpectedRoad {
  RoadWarp warp;
  DrivenPath path;
};

/// The road of a warp in units of its baseline, as RoadObservations::predicted_plane has it.
GroundPlane plane_in_baselines(const RoadWarp& expected);
/// The inverse: a plane in baselines of a motion, |t| = 1, as the warp that it means for a camera of that height.
RoadWarp warp_in_metres(const GroundPlane& in_baselines, const RigidTransform& cam2_from_cam1, double camera_height_m);

/// A pair's road matches as what a plane is measured from: the pair's motion with its covariance, |t| = 1; the road's
/// points, which count less the farther they lie from the path (all alike in a fixed region, where nothing is known of
/// a path); the points of the whole image that agree with the motion. Of what is predicted, images and region nothing
/// is said. O(points).
RoadObservations observe_pair(const Pair& pair, const Matches& road_matches, const CameraPtr& camera,
                              const ExpectedRoad& expected, const RegionOptions& region);

}  // namespace groundscale
