#pragma once

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/drive_choice.hpp"
#include "groundscale/experiments/experiment.hpp"
#include "groundscale/experiments/measured_run.hpp"

namespace groundscale {

inline constexpr const char* kDrivesName = "drives";
inline constexpr const char* kDrivesSummary =
    "scale, trajectory, time and memory of `run` on long simulated drives against their exact truth";

/// The experiment `drives` (docs/experiments.md): each drive is simulated, run and evaluated, and what came of all of
/// them is put together in tables and figures. A drive that fails leaves the others alone.
/// @return kBadInput, before anything is written, for what is wrong with options, settings and folder; kIo where the
/// report can't be written.
Result<ExperimentOutcome> run_drives(const DriveOptions& options, const RunSettings& settings,
                                     const ExperimentRequest& request);

}  // namespace groundscale
