#pragma once

#include <string>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/drive_choice.hpp"
#include "groundscale/experiments/experiment.hpp"

namespace groundscale {

/// A rendered drive with its truth, as `groundscale simulate` writes it.
struct RenderedDrive {
  std::string name;
  std::string folder;
  std::string key;      ///< All that made it; for the keys of what is made from it.
  std::string command;  ///< Makes it by hand.

  std::string truth() const { return folder + "/poses.txt"; }
};

/// The one place where experiments get drives from. Rendered once into `folder`, and kept there while version,
/// arguments and the content of the pose and time files stay the same.
/// @return kIo where rendering fails, which has said why on the standard error; kBadInput where `folder` is somebody
/// else's.
Result<RenderedDrive> obtain_drive(const DriveChoice& drive, const DriveOptions& options, const std::string& folder,
                                   const ExperimentRequest& request);

}  // namespace groundscale
