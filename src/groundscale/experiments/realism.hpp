#pragma once

#include <string>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/drive_choice.hpp"
#include "groundscale/experiments/experiment.hpp"
#include "groundscale/experiments/measured_run.hpp"

namespace groundscale {

inline constexpr const char* kRealismName = "realism";
inline constexpr const char* kRealismSummary =
    "real drives beside simulated ones over the same poses: images, matches, scale of single measurements";

/// Which real drives.
struct RealismOptions {
  /// Folder with a real drive a sequence: `NN/image_0`, `NN/calib.txt` or `camera.yaml`, `NN/poses.txt` (its truth) and
  /// `NN/times.txt`, a row an image.
  std::string clips;
  DriveOptions drives;   ///< `kitti` and `sequences` must be given.
  int pair_frame = 100;  ///< Shown as a pair of pictures.
};

/// The experiment `realism` (docs/experiments.md): the same run on a real drive and on one that is simulated over its
/// poses, and figures of both.
/// @return kBadInput, before anything is written; kIo where a step fails or the report can't be written.
Result<ExperimentOutcome> run_realism(const RealismOptions& options, const RunSettings& settings,
                                      const ExperimentRequest& request);

}  // namespace groundscale
