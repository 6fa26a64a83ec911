#pragma once

#include <optional>
#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/aims.hpp"
#include "groundscale/experiments/drive_choice.hpp"
#include "groundscale/experiments/experiment.hpp"
#include "groundscale/experiments/measured_run.hpp"

namespace groundscale {

/// Trajectories of several modes, and of other systems, on the same drives.
struct ContestOptions {
  DriveOptions drives;
  std::vector<std::string> modes;    ///< choose_modes.
  std::vector<std::string> compare;  ///< parse_compared.
  int seeds = 0;                     ///< How often the best mode is run on the first drive, each with another seed.
  /// Drives are rendered with this k1 and run as if there were none.
  std::optional<double> distortion;
};

/// An experiment of this kind.
struct Contest {
  std::string name;
  std::string summary;
  std::vector<Aim> (*aims)(const std::vector<ContestedDrive>& drives, const std::string& best);
};

/// Each drive is run once a mode; tables, figures and aims are written anew after each drive. A run that fails leaves
/// the others alone.
/// @return kBadInput, before anything is written; kIo where no drive comes to its end or the report can't be written.
Result<ExperimentOutcome> run_contest(const Contest& contest, const ContestOptions& options,
                                      const RunSettings& settings, const ExperimentRequest& request);

}  // namespace groundscale
