#pragma once

#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/drive_choice.hpp"
#include "groundscale/experiments/rendered_drive.hpp"

namespace groundscale {

/// Drives that are there already, in KITTI odometry's layout: real ones, unless a `simulation.yaml` lies in them.

/// Names of the folders in `parent` that hold images (`image_0` to `image_3`), sorted.
std::vector<std::string> recorded_in(const std::string& parent);

/// Such a drive's folder and truth as a drive to work on, all of it.
/// @param truth  KITTI or TUM rows, row i is image i.
/// @return kBadInput where images or truth are missing, or the truth has a row without an image.
Result<DriveChoice> recorded_choice(const std::string& name, const std::string& folder, const std::string& truth);

/// The drive as others are rendered, with a key that changes with its truth, camera, times, configuration, last image.
/// @pre choice.recorded is set. @return errors of file_digest.
Result<RenderedDrive> recorded_drive(const DriveChoice& choice);

}  // namespace groundscale
