#pragma once

#include <functional>
#include <string>

#include "groundscale/core/result.hpp"
#include "groundscale/simulation/drive_simulation.hpp"

namespace groundscale {

struct DriveOutput {
  std::string folder;
  bool force = false;       ///< Write into a folder that holds something.
  bool depth = false;       ///< Also `depth`, an image a frame.
  bool road_masks = false;  ///< Also `road_masks`, an image a frame.
  int frames = 0;           ///< The first so many of the drive; all of them where 0.
  int threads = 1;
  std::string cache_folder;  ///< Where images are kept for the next time; none where empty.
};

/// The user's folder for rendered drives, `$XDG_CACHE_HOME` or `~/.cache` and in it `groundscale/drives`; empty where
/// neither is known.
std::string user_cache_folder();

/// A name for all that makes a drive's images: the same drive, options and world version have the same, whatever the
/// number of frames; by 64 bits of a hash.
std::string drive_key(const SimulatedDrive& drive);

/// Renders a drive into a KITTI odometry folder (docs/simulation.md). Rows and images grow together: what is there
/// after a failure is a shorter drive. A kept image that can't be decoded or has another size is rendered again.
/// @param source    How the drive can be had again, for `simulation.yaml`.
/// @param progress  Called after each frame with how many are done.
/// @return kBadInput where the folder holds something and `force` isn't set, and where the drive is shorter than
/// `frames`;
///         kIo, saying how many frames were written.
Result<void> write_drive(const SimulatedDrive& drive, const DriveOutput& output, const std::string& source,
                         const std::function<void(int)>& progress);

}  // namespace groundscale
