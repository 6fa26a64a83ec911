#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/drive_choice.hpp"
#include "groundscale/experiments/experiment.hpp"

namespace groundscale {

inline constexpr const char* kSyntheticName = "synthetic";
inline constexpr const char* kSyntheticSummary =
    "scale error of the methods over pixel noise, on made-up matches of a level road, as the paper's section VI-A";

struct SyntheticOptions {
  /// Names of `ground_methods`; empty: those of the paper's comparison.
  std::vector<std::string> methods;
  std::string source;    ///< A drive whose road features are taken; "": the simulator's route `straight`.
  std::string camera;    ///< Camera file of `source`; "": the one that lies with it.
  DriveOptions drive{};  ///< How `straight` is rendered: preset, seed, threads.
  int frames = 40;       ///< Of the drive; trial k has the features of frame k modulo this.
  /// x, y, x, y, ... of the road region; empty: the default strip of a level camera.
  std::vector<double> region_px;
  std::vector<double> speeds_kmh = {12.5, 50.0};
  double rate_hz = 10.0;
  double max_noise_px = 2.0;
  double noise_step_px = 0.25;
  int trials = 200;                                                    ///< A point.
  std::vector<double> pitch_errors_deg = {0.0, 0.5, 1.0, -0.5, -1.0};  ///< Of what `triangulation` is told.
  int seed = 0;                                                        ///< Of scene and noise.
  /// KEY=VALUE of the odometry's configuration: what the methods and the motion are made with, over settings that
  /// refuse nothing for its noise.
  std::vector<std::string> assignments;
};

/// The experiment `synthetic` (docs/experiments.md).
/// @return kBadInput, before anything is written where that is possible; kIo where rendering fails or the report can't
/// be written.
Result<ExperimentOutcome> run_synthetic(const SyntheticOptions& options, const ExperimentRequest& request);

}  // namespace groundscale
