#pragma once

#include <cstdint>
#include <vector>

#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/simulation/camera_rig.hpp"
#include "groundscale/simulation/laid_road.hpp"
#include "groundscale/simulation/route.hpp"

namespace groundscale {

/// Where the camera is while its shutter is open. Equal poses: no motion blur.
struct Shutter {
  RigidTransform world_from_cam_open;
  RigidTransform world_from_cam_close;
};

/// The camera when it takes an image.
struct CameraMoment {
  double time_s = 0.0;
  double distance_m = 0.0;  ///< Along the driven path.
  double speed_mps = 0.0;
  RigidTransform world_from_cam;  ///< In the middle of the exposure; world as for paths.
  Shutter shutter;
};

/// The pose a share (0 to 1) of the way from one to the other, at an even rate; beyond, it goes on so.
RigidTransform between(const RigidTransform& from, const RigidTransform& to, double share);

/// A camera driven along a route; the vehicle's suspension gives as the rig says.
/// @param surface  The road along the route's path.
std::vector<CameraMoment> moments_of_route(const RoadSurface& surface, const Route& route, const CameraRig& rig,
                                           double rate_hz, double shutter_s, std::uint64_t seed);

/// A camera at given poses.
/// @param times_s  A time each, ascending.
std::vector<CameraMoment> moments_of_laid_road(const LaidRoad& road, const std::vector<double>& times_s,
                                               double shutter_s);

}  // namespace groundscale
