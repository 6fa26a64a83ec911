#pragma once

#include <optional>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/evaluation/absolute_errors.hpp"
#include "groundscale/evaluation/kitti_errors.hpp"
#include "groundscale/evaluation/pairing.hpp"
#include "groundscale/evaluation/scale_errors.hpp"
#include "groundscale/evaluation/steps.hpp"

namespace groundscale {

/// Scale errors over all moving steps that have a value, and over the straights and turns among them.
struct ScaleFigures {
  int steps = 0;  ///< With a value.
  std::optional<ScaleErrors> all;
  std::optional<ScaleErrors> straight;
  std::optional<ScaleErrors> turn;
  std::optional<ScaleDrift> drift;
};

/// What the poses themselves say, without alignment but where the name says so.
struct PathFigures {
  double estimated_m = 0.0;  ///< Length of the path, over all steps.
  double true_m = 0.0;
  int rotations = 0;                ///< Steps behind the rotation error: all.
  double rotation_error_rad = 0.0;  ///< Median a step.
  KittiErrors kitti;
  std::optional<AbsoluteErrors> absolute;  ///< Empty where nothing can be aligned (fewer than three rows).
};

/// A share with what it is of.
struct Share {
  int of = 0;
  int count = 0;
  double value() const { return static_cast<double>(count) / of; }
};

/// How many steps lie within two standard deviations of the truth.
struct SdShares {
  Share all, straight, turn;
};

/// How often there was a measurement, over the moving steps; from a run's folder only.
struct Coverage {
  Share accepted;                                ///< Steps with an accepted raw measurement.
  Share filtered;                                ///< Steps with a filtered value, that is with a standard deviation.
  Share filtered_after_first;                    ///< The same over the steps from the first accepted frame on.
  std::optional<int> first_accepted_frame;       ///< Its number in the source.
  std::optional<int> moving_steps_before_first;  ///< Moving steps before that frame.
  SdShares within_2_sd;                          ///< Of the filtered steps: final step within 2 step_sd_m of the truth.
  SdShares online_within_2_sd;                   ///< Online step within 2 online_step_sd_m; none in tables without it.
  Share raw_within_2_sd;                         ///< Of the accepted ones: raw step within 2 raw_step_sd_m.
};

/// All that `groundscale evaluate` says about a drive.
struct Evaluation {
  int rows = 0;
  int moving_steps = 0;
  int turn_steps = 0;  ///< Moving steps in turns.
  ScaleFigures scale;
  PathFigures path;
  std::optional<ScaleFigures> online_scale;
  std::optional<PathFigures> online_path;
  std::optional<ScaleFigures> raw_scale;
  std::optional<Coverage> coverage;
};

/// Compares rows that belong together. Definitions: docs/evaluation.md.
/// @return kBadInput as compare_steps and kitti_errors, and for a truth that stands still. O(n log n).
Result<Evaluation> evaluate(const PairedDrive& drive, const std::vector<double>& lengths_m,
                            const StepRules& rules = {});

}  // namespace groundscale
