#pragma once

#include <memory>
#include <string>

#include "groundscale/core/result.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/sequence.hpp"

namespace groundscale {

/// A drive's images, opened, and its camera, whose height is known.
struct SourceDrive {
  std::unique_ptr<Sequence> sequence;
  CameraSetup setup;
};

/// @param source  As `run` takes it.
/// @param camera  Camera file; "": the one that lies with the images.
/// @param frames  At most so many; 0: all.
/// @return kBadInput: nothing to read there, no camera, no height (KITTI's layout has its documented 1.65 m).
Result<SourceDrive> open_source_drive(const std::string& source, const std::string& camera, int frames);

}  // namespace groundscale
