#pragma once

#include <cstdint>

#include "groundscale/simulation/material.hpp"
#include "groundscale/simulation/ray_scene.hpp"
#include "groundscale/simulation/road_surface.hpp"

namespace groundscale {

/// What a seed makes of a world changes only with this number.
inline constexpr int kWorldVersion = 2;

struct WorldOptions {
  std::uint64_t seed = 0;
  RoadProfile profile;
  AsphaltOptions asphalt;
  bool side_roads = true;      ///< Where the path turns off.
  double houses_share = 0.85;  ///< Of the frontage that is built up.
  double hedges_share = 0.3;   ///< Of front gardens; hedges, walls and fences together at most 1.
  double walls_share = 0.2;
  double fences_share = 0.2;
  double trees_a_side_m = 25.0;  ///< Mean distance between trees; 0: none.
  double bushes_a_side_m = 8.0;  ///< The same for bushes.
  double poles_a_side_m = 25.0;  ///< Street lamps and signs.
  double boxes_a_side_m = 35.0;  ///< Bins and cabinets.
  double cars_share = 0.35;      ///< Of the kerb that has cars parked along it.
  double sun_elevation_deg = 40.0;
  double sun_azimuth_deg = 60.0;  ///< From the start's direction of travel, to the right.

  /// Nothing beside the road.
  static WorldOptions bare();
};

/// All that stands still about a path, made up from a seed.
struct World {
  WorldOptions options;
  RoadSurface surface;
  RayScene scene;

  /// Unit vector towards the sun.
  Eigen::Vector3d sun() const;
};

World make_world(const Path& path, const WorldOptions& options);

}  // namespace groundscale
