#pragma once

#include "groundscale/calibration/calibrate.hpp"

namespace groundscale {

/// Focal length in px of a pinhole that sees so many degrees from left to right.
double focal_of_view(double fov_deg, int width);

/// Focal length of a pinhole of which nothing is known, in px: the one with which a drive's tracks fit best.
///
/// Fields of view from 40 to 120 degrees are tried on the drive's first frames: odometry, then a batch adjustment that
/// frees focal length and radial coefficient, and the best of them goes on. (Vanishing points of a street that a camera
/// looks along lie near infinity in two of three directions; tracks tell more.)
/// @param setup  A pinhole with its principal point in the image's middle; its focal length doesn't matter.
/// @return kTooFewMatches where none of them leads anywhere. Within some percent where the drive turns; see
/// `calibrate`.
Result<double> search_focal(const CalibrationDrive& drive, const CameraSetup& setup, const OdometryOptions& odometry,
                            const CalibrateOptions& options, const CalibrateProgress& progress = {});

}  // namespace groundscale
