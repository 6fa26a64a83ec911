#pragma once

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/calibration_parts.hpp"
#include "groundscale/experiments/experiment.hpp"
#include "groundscale/experiments/measured_run.hpp"

namespace groundscale {

inline constexpr const char* kCalibrationName = "calibration";
inline constexpr const char* kCalibrationSummary =
    "how near `calibrate` comes to a known camera on simulated drives, and how honest its standard deviations are";

/// The experiment `calibration` (docs/experiments.md). Tables and aims are written anew after each calibration; one
/// that fails leaves the others alone.
/// @param settings  Its assignments hold for the odometry; the rest is left aside.
/// @return kBadInput, before anything is written; kIo where nothing comes to its end or the report can't be written.
Result<ExperimentOutcome> run_calibration(const CalibrationTrialOptions& options, const RunSettings& settings,
                                          const ExperimentRequest& request);

}  // namespace groundscale
