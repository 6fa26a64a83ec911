#pragma once

#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/drive_choice.hpp"
#include "groundscale/experiments/experiment.hpp"

namespace groundscale {

inline constexpr const char* kContaminationName = "contamination";
inline constexpr const char* kContaminationSummary =
    "scale error of the methods over how much of the region isn't road, on simulated drives";

struct ContaminationOptions {
  std::vector<std::string> methods;  ///< Names of `ground_methods`; empty: all.
  DriveOptions drives;
  std::vector<double> shares_percent = {0, 10, 20, 30, 40, 50};  ///< Of the region that isn't road.
  bool true_motion = false;                                      ///< R and t of the truth.
  std::vector<std::string> assignments;                          ///< KEY=VALUE of the odometry's configuration.
};

/// The experiment `contamination` (docs/experiments.md).
/// @return kBadInput, before anything is written; kIo where no drive comes to its end or the report can't be written.
Result<ExperimentOutcome> run_contamination(const ContaminationOptions& options, const ExperimentRequest& request);

}  // namespace groundscale
