#pragma once

#include <string>

#include "groundscale/core/result.hpp"

namespace groundscale {

/// Two camera files: the one that drives are rendered with, and the one that the run believes in.
struct DistortedCameras {
  std::string rendered;  ///< The preset's pinhole, with k1 as its only distortion.
  std::string believed;  ///< The same without distortion, at the preset's height.
};

/// @return kBadInput where the preset is no pinhole or its images fold back under k1.
Result<void> check_distortion(const std::string& preset, double k1);
/// Writes them into a folder, which is made. @return the same; kIo.
Result<DistortedCameras> write_distorted_cameras(const std::string& preset, double k1, const std::string& folder);

}  // namespace groundscale
