#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/experiment.hpp"
#include "groundscale/experiments/rendered_drive.hpp"

namespace groundscale {

/// How the odometry is to be run on a drive.
struct RunSettings {
  std::vector<std::string> assignments;  ///< KEY=VALUE of the configuration: --set.
  std::optional<int> seed;
  std::string camera{};  ///< Camera file instead of the drive's own; "": none.

  /// @return kBadInput: unknown key, value out of range.
  Result<void> validate() const;
};

/// A run and its comparison with the truth, as they were done and measured.
struct MeasuredRun {
  std::string folder;
  std::vector<std::string> commands;  ///< `run` and `evaluate`, by hand.
  /// By the names of docs/evaluation.md; those of `matching` in summary.json (docs/formats.md) as `matching_...`.
  std::map<std::string, std::optional<double>> figures;
  double refused_share = 0.0;  ///< Of moving frames.
  int frames = 0;
  int lost = 0;                    ///< Frames of state `lost`.
  std::optional<int> corrections;  ///< How often the scale was corrected; empty where the run doesn't say.
  int moving_steps = 0;
  int turn_steps = 0;
  double length_m = 0.0;   ///< Of the truth, over the frames run.
  double median_ms = 0.0;  ///< A frame, reading included.
  double p95_ms = 0.0;
  double peak_memory_mb = 0.0;  ///< Of the whole process.
  double wall_s = 0.0;
  std::string processor;
  std::vector<std::string> warnings;

  std::optional<double> figure(const std::string& name) const;
};

/// Runs the odometry on a drive into `folder`, with the drive's config.yaml where it has one, compares it with the
/// drive's truth, and keeps what it took. Done once while the drive, the settings and the program (version and bytes)
/// stay the same.
/// @return as run_step; kIo where a kept result can't be read.
Result<MeasuredRun> measure_run(const RenderedDrive& drive, const RunSettings& settings, const std::string& folder,
                                const ExperimentRequest& request);

}  // namespace groundscale
