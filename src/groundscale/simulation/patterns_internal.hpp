#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "groundscale/simulation/material.hpp"

namespace groundscale::internal {

/// Share of a patch of side `footprint` about `x` that lies in [low, high].
double covered(double x, double low, double high, double footprint);

struct Tiles {
  double width_m = 0.3;
  double height_m = 0.3;
  double joint_m = 0.012;
  double contrast = 0.12;  ///< Between tiles.
  bool bonded = false;     ///< Every other row is shifted by half a tile.
};
/// About 1: tiles that differ from each other, with dark joints.
double tiles(const Eigen::Vector2d& uv, double footprint, const Tiles& tiles, std::uint64_t seed);

/// Mean 1: rough at lengths from `longest_m` down over `octaves` halvings.
struct Roughness {
  double longest_m = 1.0;
  int octaves = 5;
  double sd = 0.1;  ///< Of all octaves together.
};
double rough(const Eigen::Vector2d& uv, double footprint, const Roughness& roughness, std::uint64_t seed);

/// What stands beside the road, as albedo() has it.
double object_albedo(Material material, int variant, const Eigen::Vector2d& uv, double footprint, std::uint64_t seed);

}  // namespace groundscale::internal
