#pragma once

#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/drive_choice.hpp"
#include "groundscale/experiments/experiment.hpp"

namespace groundscale {

inline constexpr const char* kTimingName = "timing";
inline constexpr const char* kTimingSummary =
    "time a frame of the methods, on the same frames; matching and motion apart";

struct TimingOptions {
  std::vector<std::string> methods;  ///< Names of `ground_methods`; empty: all.
  DriveOptions drives;
  std::vector<std::string> assignments;  ///< KEY=VALUE of the odometry's configuration.
};

/// The experiment `timing` (docs/experiments.md).
/// @return kBadInput, before anything is written; kIo where no drive comes to its end or the report can't be written.
Result<ExperimentOutcome> run_timing(const TimingOptions& options, const ExperimentRequest& request);

}  // namespace groundscale
