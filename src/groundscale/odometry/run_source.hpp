#pragma once

#include <optional>
#include <string>

#include "groundscale/core/options.hpp"
#include "groundscale/io/sequence.hpp"
#include "groundscale/odometry/options.hpp"

namespace groundscale {

/// What a run reads, as the section `run` of a configuration says it. Paths are taken from the working folder.
struct RunSource {
  std::string source;            ///< KITTI odometry folder, image folder or video.
  int image = -1;                ///< KITTI's image folder; -1: image_0, else the first that is there.
  int start = 0;                 ///< First frame.
  int frames = 0;                ///< At most so many; 0: all.
  std::string camera;            ///< Camera file or calib.txt; "": the one that lies with the images.
  double camera_height_m = 0.0;  ///< 0: the camera file's, else KITTI's.
  std::string road_masks;        ///< Folder of masks; "": none.

  SequenceRequest request() const;
};

void visit_fields(RunSource& source, FieldVisitor& visitor);

/// Everything that a configuration file may say: the odometry's options, and in the section `run` what is read.
struct RunConfig {
  OdometryOptions odometry;
  RunSource run;

  Result<void> validate() const;
  /// The same with absolute paths, so that it means the same from any working folder.
  RunConfig absolute() const;
};

void visit_fields(RunConfig& config, FieldVisitor& visitor);

}  // namespace groundscale
