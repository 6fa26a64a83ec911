#pragma once

#include <optional>
#include <vector>

#include "groundscale/calibration/odometer.hpp"
#include "groundscale/calibration/speed_pairs.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/geometry/speed_log.hpp"

namespace groundscale {

/// Where the clock offset is looked for. A time by the log's clock is the same by the video's plus the offset.
struct ClockSearch {
  std::optional<double> offset_s = std::nullopt;  ///< Given: not looked for.
  double max_offset_s = 60.0;                     ///< To both sides of where the search begins.
  double video_start_s = 0.0;  ///< Where the log's first row is laid if its clock is quite another one.
};

struct ClockOffset {
  double offset_s = 0.0;
  double sd_s = 0.0;  ///< By how well other offsets would do; 0 where it was given.
  bool given = false;
  bool aligned = false;   ///< The log's clock is another one: its start was laid at the video's before.
  bool found = false;     ///< Given, or the speeds vary enough to tell it: sd below a second.
  SpeedNoise noise = {};  ///< Of the log, at this offset.
  /// Offsets that do about as well, with their weights, which sum to 1. Where the offset was found: that one alone.
  struct Candidate {
    double offset_s = 0.0;
    double weight = 1.0;
  };
  std::vector<Candidate> candidates = {};
};

/// The offset at which the speeds of log and odometry agree best, whatever their ratio: the least cost of fit_ratio
/// over all of it, standing included, sub-sample by a parabola. Offsets that share less than half of the time that the
/// best-covering one shares, or less than 10 s, aren't looked at.
///
/// Clocks are taken for the same up to max_offset_s where log and video overlap so. Where they are more than an hour
/// apart the log's is another clock (seconds since 1970, say), and its first row is laid at the video's start.
/// @return kBadInput where log and video don't overlap; kNotConverged where the best offset is the end of the range.
/// Deterministic. O(range * pieces).
Result<ClockOffset> find_clock_offset(const SpeedLog& log, const Odometer& odometer, const ClockSearch& search);

/// The best offset near one that is known: within 0.6 s of `near_s`. For parts of a drive.
double refine_clock_offset(const std::vector<LogPiece>& pieces, const Odometer& odometer, const SpeedNoise& noise,
                           double near_s);

}  // namespace groundscale
