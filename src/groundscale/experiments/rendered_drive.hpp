#pragma once

#include <string>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/drive_choice.hpp"
#include "groundscale/experiments/experiment.hpp"

namespace groundscale {

/// A drive with its truth: rendered, as `groundscale simulate` writes it, or a real one in the same layout.
struct RenderedDrive {
  std::string name;
  std::string folder;
  std::string key{};         ///< All that made it; for the keys of what is made from it.
  std::string command{};     ///< Makes it by hand; "" where it was there.
  std::string truth_file{};  ///< "": poses.txt in its folder.
  int frames = 0;            ///< The first so many are wanted; 0: all that are there.
  bool real = false;         ///< Of the road, not simulated.

  std::string truth() const { return truth_file.empty() ? folder + "/poses.txt" : truth_file; }
};

/// The one place where experiments get drives from. A real one is where it is. Others are rendered once into `folder`,
/// and kept there while version, arguments and the content of the pose and time files stay the same.
/// @return kIo where rendering fails, which has said why on the standard error; kBadInput where `folder` is somebody
/// else's.
Result<RenderedDrive> obtain_drive(const DriveChoice& drive, const DriveOptions& options, const std::string& folder,
                                   const ExperimentRequest& request);

}  // namespace groundscale
