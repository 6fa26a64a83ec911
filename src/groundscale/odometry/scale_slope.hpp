#pragma once

#include <optional>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/odometry/frame_result.hpp"

namespace groundscale {

/// How fast the scale of an odometry that isn't corrected runs away from the ground's.
struct ScaleSlope {
  /// A measurement of the ground.
  struct Sample {
    double distance_m = 0.0;  ///< Driven.
    double log_ratio = 0.0;   ///< log(odometry's scale / ground's)
    double sd = 0.0;          ///< Of it.
  };

  double per_100m = 0.0;     ///< Of log(odometry's scale / ground's), > 0: lengths grow too long.
  double sd_per_100m = 0.0;  ///< From blocks of 25 m.
  double length_m = 0.0;     ///< Way between first and last measurement.
  int measurements = 0;
  double level = 0.0;           ///< Of the line at distance 0: log ratio = level + per_100m distance_m / 100.
  std::vector<Sample> samples;  ///< Through which it is laid, along the way.
};

/// A straight line through measurements by Cauchy-weighted least squares, each by its sd.
/// @param samples  Distances ascending. @return kTooFewMatches below 30 m or 20 measurements.
Result<ScaleSlope> fit_scale_slope(std::vector<ScaleSlope::Sample> samples);

/// Several lines of one odometry: slopes by their sds, lengths and measurements together; samples and level are those
/// of the longest. Nothing where there are none.
std::optional<ScaleSlope> combined_slope(std::vector<ScaleSlope> lines);

/// Slope of y = -log(the ground's metres per unit of the map) over the driven distance, whatever scale is held
/// meanwhile (fit_scale_slope). Its measurements have larger sds in turns. Where one map ends and another begins, or a
/// map is scaled, a new line begins; the slopes of several are combined by their sds, the samples and the level are
/// those of the longest.
/// @param results  Of a keyframe odometry, finished.
/// @param scaled  Where maps were scaled.
/// @return kTooFewMatches where no line is long enough.
Result<ScaleSlope> scale_slope(const std::vector<FrameResult>& results, const std::vector<ScaleEvent>& scaled = {});

}  // namespace groundscale
