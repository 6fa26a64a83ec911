#pragma once

#include <optional>
#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/evaluation/frame_table.hpp"
#include "groundscale/geometry/trajectory.hpp"

namespace groundscale {

/// What to compare with what.
struct PairingRequest {
  std::string estimate;  ///< A run's folder, or a trajectory file (KITTI or TUM rows).
  std::string truth;     ///< A trajectory file (KITTI or TUM rows).
  int truth_offset = 0;  ///< Row (or, from a run's folder, frame) i of the estimate is row i + this of the truth.
  int skip = 0;          ///< So many first rows of the estimate are left out.
  /// What the caller's user can do where the truth lacks rows; ends the message.
  std::string advice = "see --truth-offset";
};

/// Rows of estimate and truth that belong together, all of one length.
struct PairedDrive {
  Trajectory estimate;
  Trajectory truth;  ///< With times where there are any, whichever file they come from.
  std::optional<Trajectory> online;
  std::vector<FrameRow> frames;                 ///< Empty unless the estimate is a run's folder.
  std::vector<int> truth_rows;                  ///< Which row of the truth each row is.
  int rows_of_truth = 0;                        ///< In the whole file.
  std::string times_from;                       ///< File that the times come from; empty without times.
  std::optional<double> max_time_difference_s;  ///< Where rows were matched by time.
};

/// Reads both sides and pairs their rows.
///
/// Rows of a KITTI file by their number; rows of a run's folder by frame number; rows of a TUM file by time, each with
/// the nearest of the truth, at most 0.02 s away. A TUM estimate against a KITTI truth takes the truth's times from a
/// `times.txt` beside it.
/// @return kBadInput: files that can't be read, rows without a partner (both counts are named, nothing is cut), a run
/// that
///         did not end, fewer than two rows.
Result<PairedDrive> pair_drive(const PairingRequest& request);

}  // namespace groundscale
