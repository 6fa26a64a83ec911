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
  double roughness_m = 0.004;   ///< Sd of the roadway's height against its smooth shape, over waves of 0.7 to 6 m.
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
  int road = 0;                ///< Whose markings lie there; 0: the driven path's, 1 and up: side roads.
  PathPoint on_path;           ///< Nearest point of that road's path.
  double from_crest_m = 0.0;   ///< To the right of that road's crest; negative: to its left.
  double beyond_edge_m = 0.0;  ///< Outside of all roads: distance to the nearest one's kerb; inside below 0.
  bool junction = false;       ///< Roads of different directions lie there.
  double ground_y = 0.0;       ///< World y (down) of the ground.
  Ground ground = Ground::kVerge;
};

/// The ground about a driven path and its side roads: a height for every place seen from above, the same whenever the
/// path comes by. Where roads meet they are one: kerbs surround all of them, and heights go over from one to the other.
/// The road that a path passed first keeps its markings.
class RoadSurface {
 public:
  RoadSurface(Path path, const RoadProfile& profile, std::vector<Path> side_roads = {});

  const Path& path() const { return roads_.front(); }
  /// The driven path, then the side roads.
  const std::vector<Path>& roads() const { return roads_; }
  const RoadProfile& profile() const { return profile_; }

  /// The road at (x, z); within `reach_m()` of a path, beyond it nothing is known (from_crest_m is at least that
  /// large).
  RoadPlace locate(double x, double z) const;
  double ground_y(double x, double z) const { return locate(x, z).ground_y; }
  /// Unit normal of the ground, upwards, over a patch of about a metre.
  Eigen::Vector3d ground_normal(double x, double z) const;

  static double reach_m() { return 40.0; }
  /// A road goes on straight so far before its start and behind its end.
  static double lead_m() { return 40.0; }
  static double tail_m() { return 120.0; }

 private:
  struct Sample {
    int road = 0;
    PathPoint point;
  };
  /// The place as one pass of a road has it.
  struct Pass {
    int road = 0;
    PathPoint on_path;
    double lateral_m = 0.0;  ///< To the right of the path.
    double from_crest_m = 0.0;
  };

  std::int64_t cell_of(double x, double z) const;
  std::vector<Pass> passes_at(double x, double z) const;
  Pass pass_at(const Sample& nearest, double x, double z) const;
  double road_y(const std::vector<Pass>& passes) const;
  double rise_beyond(double beyond_edge_m) const;
  double roughness(double x, double z, double beyond_edge_m) const;

  std::vector<Path> roads_;
  RoadProfile profile_;
  std::vector<Sample> samples_;
  std::unordered_map<std::int64_t, std::vector<int>> cells_;  ///< Samples within reach of a cell; only looked up.
};

/// Roads that lead straight on where a path turns off, as at a crossing: from each turn of at least 60 degrees, where
/// no part of the path itself lies.
std::vector<Path> side_roads_of(const Path& path);

}  // namespace groundscale
