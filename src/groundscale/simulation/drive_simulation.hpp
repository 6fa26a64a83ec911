#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/geometry/ground_plane.hpp"
#include "groundscale/simulation/camera_rig.hpp"
#include "groundscale/simulation/renderer.hpp"
#include "groundscale/simulation/sensor.hpp"
#include "groundscale/simulation/world.hpp"

namespace groundscale {

/// A camera with all that decides what its images look like.
struct SimulatedCamera {
  CameraPtr camera;
  CameraRig rig;
  double rate_hz = 10.0;
  double shutter_s = 0.004;
  SensorOptions sensor;
  RenderOptions quality;
};

/// @return kBadInput with the list of names where there is no preset of this one.
Result<SimulatedCamera> find_camera_preset(std::string_view name);

/// What a frame of a simulated drive truly is.
struct FrameTruth {
  double time_s = 0.0;
  RigidTransform world_from_cam;  ///< In the middle of the exposure; world as for paths.
  Shutter shutter;
  double height_m = 0.0;  ///< Perpendicular to the road beneath the camera.
  GroundPlane plane;      ///< Best plane over the lane ahead, in the camera.
  double speed_mps = 0.0;
};

/// The drive's frames from the first; at most `max_frames`.
std::vector<FrameTruth> truth_of_drive(const World& world, const Route& route, const SimulatedCamera& camera,
                                       int max_frames, std::uint64_t seed);

struct DriveOutput {
  std::string folder;
  bool force = false;
};

/// Renders a drive into a KITTI odometry folder: image_0, camera.yaml, calib.txt where the camera is a pinhole without
/// distortion, times.txt, poses.txt, truth.csv.
/// @param progress  Called after each frame with how many are done.
/// @return kBadInput where the folder holds something and `force` isn't set; kIo, saying how many frames were written.
Result<void> write_drive(const World& world, const std::vector<FrameTruth>& frames, const SimulatedCamera& camera,
                         const DriveOutput& output, std::uint64_t seed, const std::function<void(int)>& progress);

}  // namespace groundscale
