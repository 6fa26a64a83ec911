#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/evaluation/evaluate.hpp"
#include "groundscale/evaluation/frame_table.hpp"
#include "groundscale/evaluation/pairing.hpp"
#include "groundscale/evaluation/steps.hpp"
#include "groundscale/geometry/trajectory.hpp"
#include "groundscale/odometry/run_writer.hpp"
#include "groundscale/report/sample_frames.hpp"

namespace groundscale {

/// A run beside the truth.
struct ComparedRun {
  PairedDrive paired;
  Evaluation evaluation;
  std::vector<Step> steps;         ///< Final; one fewer than frames.
  std::vector<Step> online_steps;  ///< Empty without online trajectory.
};

/// What `run` left in a folder, read again.
struct RunFolder {
  std::string folder;
  RunSummary summary;
  std::vector<FrameRow> frames;
  Trajectory trajectory;  ///< Final.

  /// A value of the configuration beside the default.
  struct Setting {
    std::string name, value, usual, unit;
    bool differs() const { return value != usual; }
  };
  std::vector<Setting> settings;  ///< Empty where config.yaml isn't there or of another version.
  std::string config_text;        ///< As it lies there.
  std::string drive;              ///< What was driven, with its absolute path, image and first frame: alike for runs
                                  ///< whose frames belong together.
  std::vector<SampleFrame> samples;

  std::string truth;          ///< File; empty where none is known.
  std::string truth_problem;  ///< Why the run can't be compared with it.
  std::optional<ComparedRun> compared;

  /// Way driven up to the end of each frame's step: the sums of final steps.
  std::vector<double> distances_m() const;
};

/// A run's folder beside another trajectory, with the figures of `evaluate` (kitti_lengths_m).
/// @return Errors of pair_drive, evaluate and compare_steps.
Result<ComparedRun> compare_run(const PairingRequest& request);

/// @param truth  Trajectory to compare with; empty: the one that the run was told, if any.
/// @return kBadInput with the path: no folder of a run, one of a run that didn't end (no summary.json), files that
/// can't be read or aren't of one run, a `truth` that can't be compared with. A truth that the run itself was told and
/// that is no longer there goes to `truth_problem`.
Result<RunFolder> read_run_folder(const std::string& folder, const std::string& truth = "");

}  // namespace groundscale
