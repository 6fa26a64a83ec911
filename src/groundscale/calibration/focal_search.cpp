#include "groundscale/calibration/focal_search.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace groundscale {

double focal_of_view(double fov_deg, int width) {
  return 0.5 * width / std::tan(0.5 * fov_deg * std::numbers::pi / 180.0);
}

Result<double> search_focal(const CalibrationDrive& drive, const CameraSetup& setup, const OdometryOptions& odometry,
                            const CalibrateOptions& options, const CalibrateProgress& progress) {
  constexpr int kFrames = 200;
  std::optional<double> best_px;
  double best_rms_px = 0.0;
  std::optional<Error> failed;
  for (const double fov_deg : {40.0, 55.0, 70.0, 85.0, 100.0, 120.0}) {
    const double focal_px = focal_of_view(fov_deg, setup.camera->width());
    const auto camera = with_value(CameraParameter::kFocal, focal_px, *setup.camera);
    if (!camera) return camera.error();
    CameraSetup tried = setup;
    tried.camera = *camera;
    const auto show = [&progress, fov_deg](int frames) {
      if (progress) progress(fmt::format("a field of view of {:g} degrees", fov_deg), frames);
    };
    const auto pass = drive_pass(drive, tried, odometry, options.views, show, kFrames);
    if (!pass) {
      // With this one no road is in view, say; but images that can't be read are the same with all.
      if (pass.error().code == ErrorCode::kIo) return pass.error();
      failed = pass.error();
      continue;
    }
    const auto result =
        adjust_batch(pass->tracks, *camera, {{CameraParameter::kFocal}, {CameraParameter::kRadial}}, options.batch);
    if (!result) continue;
    if (best_px && best_rms_px <= result->final_rms_px) continue;
    best_px = result->values[0];
    best_rms_px = result->final_rms_px;
  }
  if (best_px) return *best_px;
  if (failed) return *failed;
  return Error{ErrorCode::kTooFewMatches, "no focal length explains the drive's tracks: --fov gives one to start from"};
}

}  // namespace groundscale
