#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "groundscale/core/rng.hpp"
#include "groundscale/simulation/road_surface.hpp"
#include "groundscale/simulation/shapes.hpp"
#include "groundscale/simulation/world.hpp"

namespace groundscale {

/// Ground that something stands on: rectangles, seen from above.
class TakenGround {
 public:
  /// Takes the rectangle about the footing's origin unless it overlaps one that is taken already.
  /// @return Whether it was free.
  bool take(const Footing& middle, double half_along_m, double half_aside_m);

 private:
  struct Rectangle {
    Eigen::Vector2d middle, along, aside;  ///< The latter two from the middle to the sides.
  };
  static bool overlap(const Rectangle& a, const Rectangle& b);

  std::vector<Rectangle> rectangles_;
  std::unordered_map<std::int64_t, std::vector<int>> cells_;  ///< Rectangles that reach into one; only looked up.
};

/// A stretch of a road, and what things beside it are made from. Where a road comes by a place a second time, nothing
/// is put that the first pass has left no room for, so that both find the same world.
struct Roadside {
  const RoadSurface& surface;
  const WorldOptions& options;
  const Path& path;
  double begin_m = 0.0;
  double end_m = 0.0;
  TakenGround& taken;
  Meshes& meshes;

  /// Beside the path, `from_crest_m` to the right of the crest, on the ground.
  Footing footing(double distance_m, double from_crest_m) const;
  /// From the crest to the pavement's far side.
  double pavement_end_m() const;
  /// Whether no road comes nearer than `clear_m` to any of the places.
  bool clear_of_roads(const std::vector<Eigen::Vector3d>& places, double clear_m) const;
  /// Of its own for each kind of thing, so that leaving one out doesn't change the others.
  Rng generator(std::uint64_t kind) const { return Rng(options.seed ^ (kind * 0x9e3779b97f4a7c15ULL)); }
};

/// All that stands still beside a road.
void add_roadside(Roadside& roadside);

}  // namespace groundscale
