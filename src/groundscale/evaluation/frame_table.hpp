#pragma once

#include <optional>
#include <string>
#include <vector>

#include "groundscale/core/result.hpp"

namespace groundscale {

/// A row of a run's `frames.csv`. Evaluations need the columns that come first; the others may be missing.
struct FrameRow {
  int frame = 0;  ///< Number in the source.
  std::optional<double> time_s;
  std::optional<double> step_sd_m;      ///< There where the filter has a value.
  std::optional<double> online_step_m;  ///< From frames up to this one only.
  std::optional<double> online_step_sd_m;
  std::optional<double> raw_step_m;  ///< At the scale of this frame's own plane measurement.
  std::optional<double> raw_step_sd_m;
  std::string reason;  ///< Why the measurement was refused; empty where it was accepted or there was none.

  std::string state;  ///< "moving" and the like.
  std::optional<double> step_m;
  std::optional<double> pitch_deg, roll_deg;  ///< Of the measured road.
  std::optional<double> road_matches, road_inliers;
  std::optional<double> map_scale, drift_ratio;

  bool accepted() const { return reason.empty() && raw_step_m.has_value(); }
};

/// Reads `frames.csv` (docs/formats.md). Columns are found by their names; others may be there in any order. Fields may
/// stand in double quotes. @return kBadInput with file, line and column: a column that is missing, a number that is
/// none or negative, rows of another width, frame numbers that don't rise, times that fall or are only here and there.
Result<std::vector<FrameRow>> read_frame_table(const std::string& path);

}  // namespace groundscale
