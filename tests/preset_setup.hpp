#pragma once

#include "groundscale/camera/mounting.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/simulation/camera_presets.hpp"

namespace groundscale {

/// A preset's camera as an odometry takes it, its mounting known.
inline CameraSetup setup_of(const CameraPreset& camera) {
  const Mounting mounting = camera.options.rig.mounting();
  CameraSetup setup;
  setup.camera = camera.camera;
  setup.height_m = camera.options.rig.height_m;
  setup.pitch_rad = mounting.pitch_rad;
  setup.roll_rad = mounting.roll_rad;
  setup.yaw_rad = mounting.yaw_rad;
  return setup;
}

}  // namespace groundscale
