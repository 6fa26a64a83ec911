#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/io/sequence.hpp"

namespace groundscale::internal {

/// Order of file names in which numbers count as numbers: img2 before img10. Leading zeros decide only between names
/// that are equal otherwise, so that the order is total.
bool natural_less(std::string_view a, std::string_view b);

/// Names of the images in a folder, in natural order. Hidden files are left out.
/// @return kBadInput where it can't be read or holds none.
Result<std::vector<std::string>> image_names(const std::string& folder);

/// KITTI odometry folder, or a folder with images; told apart by the subfolders image_0 to image_3.
Result<std::unique_ptr<Sequence>> open_image_folder(const SequenceRequest& request);

/// Absolute path of camera.yaml, else calib.txt in the folder, else "".
std::string calibration_in(const std::string& folder);

/// Checks start and frames of a request against what is there, and cuts frames. @return number of frames to read.
Result<int> frames_to_read(const SequenceRequest& request, int available);

}  // namespace groundscale::internal
