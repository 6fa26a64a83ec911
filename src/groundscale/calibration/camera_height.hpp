#pragma once

#include <optional>
#include <vector>

#include "groundscale/calibration/clock_offset.hpp"
#include "groundscale/calibration/odometer.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/geometry/speed_log.hpp"
#include "groundscale/odometry/frame_result.hpp"

namespace groundscale {

/// The height at which the odometry ran. All its lengths are proportional to it.
struct StartHeight {
  double height_m = 1.5;
  bool known = false;  ///< Measured by somebody, not merely assumed.
};

struct HeightOptions {
  double min_speed_mps = 1.5;  ///< Slower pairs have no part in the ratio.
  /// Of the log of the height: what the road's measurement is off by as a whole, which no log can tell
  /// (docs/benchmarks.md).
  double model_sd = 0.005;
  /// Of the ratio between blocks of the drive, beyond what noise explains; above it there is no one ratio.
  double max_scatter = 0.05;
  double max_sd = 0.1;  ///< Of the log of the height; a height that is less certain is none.
};

/// The ratio of a stretch of the drive, with the sd that the log's noise alone gives it.
struct BlockRatio {
  double from_s = 0.0;  ///< By the video's clock.
  double to_s = 0.0;
  double ratio = 1.0;
  double sd = 0.0;
};

struct HeightEstimate {
  double height_m = 0.0;
  double height_sd_m = 0.0;
  double ratio = 1.0;     ///< True lengths over the odometry's.
  double ratio_sd = 0.0;  ///< From the log, without model_sd.
};

struct SpeedHeight {
  HeightEstimate height;
  ClockOffset clock;
  double offset_sd_s = 0.0;  ///< The larger of the clock's own and that from blocks; 0 where it was given.
  double compared_s = 0.0;   ///< Of the pairs that the ratio is from.
  double slow_s = 0.0;       ///< Left out because slower than min_speed_mps.
  double mean_speed_mps = 0.0;
  std::vector<BlockRatio> blocks;
  double scatter = 0.0;  ///< Of the blocks' ratios, beyond noise, relative.
};

/// The camera's height from a speed log: height = start.height_m * ratio, the ratio that of fit_ratio over all pairs
/// that move, at the clock offset of find_clock_offset.
///
/// Uncertainty: the drive is cut into 4 to 20 blocks of 5 s or more, and each left out in turn, clock offset and all
/// (jackknife; widened by Student's t for few blocks), never below the formal one; where the offset isn't found, the
/// spread of the ratio over all offsets that do is added; then model_sd.
/// @return kBadInput where the log doesn't overlap the drive, either stands still, or its unit can't be m/s (the ratio
///         says km/h or mph); kNotConverged where blocks of the drive have different ratios or the height is less
///         certain than max_sd. Deterministic.
Result<SpeedHeight> height_from_speed(const SpeedLog& log, const Odometer& odometer, const StartHeight& start,
                                      const ClockSearch& search, const HeightOptions& options = {});

/// Refuses a log in which nothing moves, before the work. @return kBadInput.
Result<void> check_moving(const SpeedLog& log, const HeightOptions& options = {});

/// A length that is known.
struct KnownDistance {
  double distance_m = 0.0;
  double distance_sd_m = 0.0;
  std::optional<double> from_s = std::nullopt;  ///< By the video's clock; else from its start
  std::optional<double> to_s = std::nullopt;    ///< to its end.
};

/// The camera's height from one known length of the way between two times. Its sd: of the length as given; of the
/// times, half a frame each; of the road's measurement, from blocks of 5 s of it; and model_sd.
/// @param results  Of a finished drive.
/// @return kBadInput where the times lie outside the drive or don't rise, or nothing moves between them; kNotConverged
///         where part of the way had to be bridged, or the height is less certain than max_sd.
Result<HeightEstimate> height_from_distance(const KnownDistance& known, const std::vector<FrameResult>& results,
                                            const StartHeight& start, const HeightOptions& options = {});

}  // namespace groundscale
