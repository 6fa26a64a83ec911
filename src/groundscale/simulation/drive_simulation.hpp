#pragma once

#include <cstdint>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/geometry/ground_plane.hpp"
#include "groundscale/geometry/trajectory.hpp"
#include "groundscale/simulation/camera_motion.hpp"
#include "groundscale/simulation/camera_presets.hpp"
#include "groundscale/simulation/world.hpp"

namespace groundscale {

/// A drive that can be rendered, from its first frame to its last: all that decides its images and its truth.
struct SimulatedDrive {
  CameraPreset camera;
  std::uint64_t seed = 0;  ///< Of world, vehicle and sensor.
  World world;
  std::vector<CameraMoment> moments;  ///< One a frame.
  bool mounted = true;                ///< The poses are those of the preset's mounting; given poses have their own.
};

/// A drive along a route, in its surroundings as the options have them.
SimulatedDrive drive_along(const Route& route, const CameraPreset& camera, std::uint64_t seed);

/// A drive at given poses, over a road that is laid under them.
/// @param times_s  A time each, rising.
/// @return kBadInput as lay_road, and where the times don't fit.
Result<SimulatedDrive> drive_along(const Trajectory& poses, const std::vector<double>& times_s,
                                   const CameraPreset& camera, std::uint64_t seed);

/// What is true of the road in a frame.
struct RoadTruth {
  double height_m = 0.0;  ///< Of the camera, perpendicular to the road beneath it.
  GroundPlane plane;      ///< Best plane over the road in the region where `run` looks for it, in the camera.
  bool has_plane = true;  ///< Whether road lies there; else `plane` is none.
};
RoadTruth road_truth(const SimulatedDrive& drive, std::size_t frame);

}  // namespace groundscale
