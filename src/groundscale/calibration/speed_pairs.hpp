#pragma once

#include <vector>

#include "groundscale/calibration/odometer.hpp"
#include "groundscale/geometry/speed_log.hpp"

namespace groundscale {

/// A piece of a speed log, about a second, without a gap. Times by the log's clock.
struct LogPiece {
  double from_s = 0.0;
  double to_s = 0.0;
  double way_m = 0.0;
};

/// Pieces that follow on one another, from sample to sample, each of 0.95 s or more and not more than that needs.
std::vector<LogPiece> pieces_of(const SpeedLog& log);

/// Mean speeds over the same time.
struct SpeedPair {
  double time_s = 0.0;  ///< Middle, by the video's clock.
  double interval_s = 0.0;
  double log_mps = 0.0;
  double driven_mps = 0.0;  ///< By the odometry.
};

/// The pieces that the odometry knows, with the log's clock `offset_s` ahead of the video's.
std::vector<SpeedPair> pairs_at(const std::vector<LogPiece>& pieces, const Odometer& odometer, double offset_s);

/// log = ratio * driven + noise. The noise of the log is white, that of the odometry grows with speed.
struct SpeedNoise {
  double log_mps = 0.3;
  double driven_relative = 0.01;
};

struct RatioFit {
  double ratio = 1.0;
  double formal_sd = 0.0;  ///< As if pairs were independent.
  double cost = 0.0;       ///< Mean of 2 rho(r / sd), about 1 where the noise is as told.
};

/// The ratio of the two ways, sum(w interval log) / sum(w interval driven), w the weights of Huber's loss with 2 for
/// (log - ratio driven) / s, s^2 = log_mps^2 + (driven_relative ratio driven)^2. A line through the origin by least
/// squares would be 7 % more certain in a town, but is biased by errors of the driven speed, and because a log that is
/// read once a second cuts off the peaks of speed. The pairs must not all stand. O(pairs).
RatioFit fit_ratio(const std::vector<SpeedPair>& pairs, const SpeedNoise& noise);

/// Robust sd of the log's noise about a ratio: 1.4826 median |log - ratio driven|, never below 0.02 m/s.
double noise_about(const std::vector<SpeedPair>& pairs, double ratio);

/// Seconds that pairs last.
double duration_of(const std::vector<SpeedPair>& pairs);

}  // namespace groundscale
