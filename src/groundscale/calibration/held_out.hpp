#pragma once

#include <optional>
#include <vector>

#include "groundscale/calibration/drive_pass.hpp"
#include "groundscale/calibration/residual_map.hpp"
#include "groundscale/camera/camera.hpp"
#include "groundscale/mapping/batch_adjustment.hpp"

namespace groundscale {

/// The drive with the tracks that take part in finding a camera: two of three.
DriveTracks without_held_out(const DriveTracks& drive);

/// Two cameras judged by every third track of some drives; the others place the views (adjust_batch), for each camera
/// anew. Neither camera may have been found with them (without_held_out).
struct HeldOut {
  double before_px = 0.0;  ///< sqrt(2 mean rho(|error|)), rho = Cauchy: the rms where no error is large.
  double after_px = 0.0;
  int tracks = 0;  ///< That both cameras give a point, and one of them a fitting one.
  std::optional<ResidualMap> residuals_before, residuals_after;
};

HeldOut compare_held_out(const std::vector<DrivePass>& passes, const CameraPtr& before, const CameraPtr& after,
                         const BatchOptions& options);

}  // namespace groundscale
