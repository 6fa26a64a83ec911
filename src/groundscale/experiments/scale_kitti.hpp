#pragma once

#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/drive_choice.hpp"
#include "groundscale/experiments/experiment.hpp"
#include "groundscale/experiments/measured_run.hpp"

namespace groundscale {

inline constexpr const char* kScaleKittiName = "scale-kitti";
inline constexpr const char* kScaleKittiSummary =
    "scale errors of every way to measure the ground on KITTI's sequences, real or simulated";

struct ScaleKittiOptions {
  DriveOptions drives;
  std::vector<std::string> methods;  ///< Names of `ground_methods`; empty: all.
};

/// The experiment `scale-kitti` (docs/experiments.md), after the figure of scale errors in Zhou, Dai, Li 2019: every
/// method on the same matches, in a fixed region and in ours, as measured, with the paper's filter and with ours.
/// @return kBadInput, before anything is written; kIo where no drive comes to its end or the report can't be written.
Result<ExperimentOutcome> run_scale_kitti(const ScaleKittiOptions& options, const RunSettings& settings,
                                          const ExperimentRequest& request);

}  // namespace groundscale
