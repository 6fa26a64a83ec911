#pragma once

#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/odometry/options.hpp"

namespace groundscale {

/// Road matches of one way to find them, between a frame and the one after it.
struct MatchedPair {
  int frame = 0;  ///< The first of both.
  double speed_mps = 0.0;
  std::string way;
  double time_ms = 0.0;           ///< Of the processor: finding points, following them.
  std::vector<double> errors_px;  ///< |pixel2 - true pixel2| of each match.
};

/// Names of the ways, in their order: both front ends on the images as they are, and on a second image that has been
/// warped as motion and plane of the frame before let expect.
const std::vector<std::string>& matching_ways();

/// All ways on all pairs of neighbouring frames of a simulated drive that has depths and road masks, from the second
/// frame on. Points are those of the default strip along the path that the road mask allows. The truth of a match: the
/// point that the depth image has at its first pixel, seen from the next frame's true pose.
/// @return kBadInput where something of the drive is missing or can't be read.
Result<std::vector<MatchedPair>> match_pairs(const std::string& drive, const OdometryOptions& options);

/// Text that `read_pairs` reads back: errors to 1e-4 px.
std::string pairs_csv(const std::vector<MatchedPair>& pairs);
/// @return kBadInput with file and line.
Result<std::vector<MatchedPair>> read_pairs(const std::string& path);

}  // namespace groundscale
