#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace groundscale {

using TrackId = std::int64_t;

/// Where a track is in one frame.
struct TrackPoint {
  TrackId id = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

/// One point seen in two frames.
struct Match {
  TrackId id = 0;
  Eigen::Vector2d pixel1 = Eigen::Vector2d::Zero();
  Eigen::Vector2d pixel2 = Eigen::Vector2d::Zero();
};

using Matches = std::vector<Match>;

/// Points of both lists with the same id. Both lists ascend in id. O(n).
Matches match_by_id(const std::vector<TrackPoint>& points1, const std::vector<TrackPoint>& points2);

}  // namespace groundscale
