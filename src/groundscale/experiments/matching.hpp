#pragma once

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/drive_choice.hpp"
#include "groundscale/experiments/experiment.hpp"
#include "groundscale/experiments/measured_run.hpp"

namespace groundscale {

inline constexpr const char* kMatchingName = "matching";
inline constexpr const char* kMatchingSummary =
    "number and precision of road matches of each front end on simulated drives, by the true transfer of each point";

/// The experiment `matching` (docs/experiments.md): drives are rendered with depths and road masks, each pair of
/// neighbouring frames is matched in every way, and each match is compared with the truth.
/// @return kBadInput, before anything is written; kIo where a step fails or the report can't be written.
Result<ExperimentOutcome> run_matching(DriveOptions drives, const RunSettings& settings,
                                       const ExperimentRequest& request);

}  // namespace groundscale
