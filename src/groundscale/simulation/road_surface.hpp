#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "groundscale/simulation/path.hpp"

namespace groundscale {

/// Cross-section of a street, the same to both sides of its crest.
struct RoadProfile {
  double lane_offset_m = 1.75;  ///< The path runs so far to the right of the crest.
  double half_width_m = 3.6;    ///< From the crest to the kerb.
  double crown = 0.02;          ///< Fall to the side, over distance.
  double kerb_m = 0.12;         ///< Height of the kerb; 0: none.
  double kerb_width_m = 0.15;   ///< Its top, the face included.
  double kerb_face_m = 0.02;    ///< Seen from above: it leans a little.
  double pavement_m = 2.0;      ///< Width beyond the kerb.
  double verge_slope = 0.05;    ///< Rise beyond the pavement, over distance.
  double verge_m = 6.0;         ///< Beyond it the ground is level.
};

/// What lies at a place of the ground.
enum class Ground { kRoad, kKerb, kPavement, kVerge };

/// A place on the ground by the road.
struct RoadPlace {
  PathPoint on_path;          ///< Nearest point of the path.
  double from_crest_m = 0.0;  ///< To the right of the road's crest; negative: to its left.
  Ground ground = Ground::kVerge;
};

/// The ground about a path: a height for every place seen from above. Where the path passes a place more than once, the
/// first pass whose road covers it decides, else the nearest, so that a second pass finds the world as it was.
class RoadSurface {
 public:
  RoadSurface(Path path, const RoadProfile& profile);

  const Path& path() const { return path_; }
  const RoadProfile& profile() const { return profile_; }

  /// The road at (x, z); within `reach_m()` of the path, beyond it nothing is known of the path (from_crest_m is at
  /// least that large).
  RoadPlace locate(double x, double z) const;
  /// World y of the ground (down) at (x, z).
  double ground_y(double x, double z) const;
  /// World y at a place that is already known.
  double ground_y(const RoadPlace& place) const;
  /// Height of the cross-section above the crest.
  double rise(double from_crest_m) const;

  static double reach_m() { return 40.0; }

 private:
  std::int64_t cell_of(double x, double z) const;

  Path path_;
  RoadProfile profile_;
  std::vector<PathPoint> samples_;
  std::unordered_map<std::int64_t, std::vector<int>> cells_;  ///< Samples within reach of a cell; only looked up.
};

}  // namespace groundscale
