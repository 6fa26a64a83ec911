#pragma once

#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/geometry/trajectory.hpp"
#include "groundscale/simulation/camera_rig.hpp"
#include "groundscale/simulation/path.hpp"
#include "groundscale/simulation/road_surface.hpp"

namespace groundscale {

/// A road under a camera that has been driven already.
struct LaidRoad {
  Path path;
  std::vector<RigidTransform> world_from_cam;  ///< The poses as given, levelled and with heights put right.
  std::vector<double> distance_m;              ///< Of each pose along the path; never falls.
  double largest_correction_m = 0.0;           ///< Of a height, against the mean correction.
};

/// Lays a smooth road under given poses: the camera's way, smoothed over a few metres and lowered by the camera's
/// height, banked as the vehicle leans on average; what is left is the vehicle's own pitch, roll and bounce.
///
/// Given heights need not agree where the path comes back (KITTI's truth is off by metres there). They are put right by
/// the smoothest correction c(s) with c(s1) - c(s2) = -(y(s1) - y(s2)) wherever two passes are one road: least squares
/// over c at knots, with c' and c'' small. Climbs that the vehicle's own attitude contradicts are taken out before.
/// Poses are raised by c and pitched by c', so that they lie to the road as before.
///
/// @param given  In any world; its down is taken from the rig's mean normal.
/// @return kBadInput where the poses are fewer than two, jump by more than 10 m, go nowhere (less than 5 m), point
///         against their way, or turn more tightly than the road's half width. Rotations and numbers are the reader's
///         to check.
Result<LaidRoad> lay_road(const Trajectory& given, const CameraRig& rig, const RoadProfile& profile);

}  // namespace groundscale
