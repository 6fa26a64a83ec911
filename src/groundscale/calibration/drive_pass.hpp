#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "groundscale/camera/mounting.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/sequence.hpp"
#include "groundscale/mapping/drive_recorder.hpp"
#include "groundscale/mapping/drive_tracks.hpp"
#include "groundscale/odometry/options.hpp"
#include "groundscale/odometry/scale_slope.hpp"

namespace groundscale {

/// A drive of the camera, that can be read again and again.
struct CalibrationDrive {
  std::string name;
  std::function<Result<std::unique_ptr<Sequence>>()> open;
};

/// What the keyframe odometry, its scale not corrected, makes of a drive with one camera.
struct DrivePass {
  DriveTracks tracks;
  std::optional<ScaleSlope> slope;     ///< Empty where the ground was seen too rarely.
  std::optional<Mounting> mounting;    ///< Medians over straight frames; empty where the ground was seen too rarely.
  std::vector<double> ground_steps_m;  ///< Of each frame by its own measurement of the ground; 0 where there is none.
  double turned_deg = 0.0;             ///< Turning in pieces of 10 m, those of less than 3 degrees left out.
  double length_m = 0.0;
  int frames = 0;
};

/// Called after each frame with how many there have been.
using PassProgress = std::function<void(int frames)>;

/// @param max_frames  At most so many; 0: all.
/// @return As make_odometry; kIo: fewer than two frames could be read.
Result<DrivePass> drive_pass(const CalibrationDrive& drive, const CameraSetup& setup, const OdometryOptions& odometry,
                             const DriveRecorderOptions& views, const PassProgress& progress = {}, int max_frames = 0);

/// Median of step with `b` / step with `a` over frames that both measured, less one: by which share lengths
/// change. Nothing where they have fewer than 20 frames in common.
std::optional<double> length_change(const std::vector<DrivePass>& a, const std::vector<DrivePass>& b);

}  // namespace groundscale
