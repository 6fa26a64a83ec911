#pragma once

#include <string_view>
#include <vector>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/simulation/simulation_options.hpp"

namespace groundscale {

/// A camera on its vehicle.
struct CameraPreset {
  CameraPtr camera;
  SimulationOptions options;
  std::vector<double> region_px;  ///< x, y, x, y, ...: where the road is in view; empty: ahead, as `run` has it.
};

/// Names of the presets, in the order of the docs.
const std::vector<std::string_view>& camera_preset_names();

/// `kitti`: the left grey camera of KITTI's odometry after rectification, with the distortion that its images still
/// have. `campus`: a fisheye on the roof that looks to the side, after Zhou et al. 2019. `small`: for tests.
/// @return kBadInput with the list of names where there is no preset of this one.
Result<CameraPreset> find_camera_preset(std::string_view name);

}  // namespace groundscale
