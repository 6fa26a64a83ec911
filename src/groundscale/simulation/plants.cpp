#include "groundscale/simulation/plants.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "groundscale/simulation/material.hpp"

namespace groundscale {
namespace {

/// A lump of leaves: a sphere whose radius varies.
void add_crown(TriangleMesh& mesh, const Eigen::Vector3d& centre, double radius, Rng& rng) {
  constexpr int kRings = 8;
  constexpr int kSectors = 12;
  std::uint32_t corners[kRings + 1][kSectors + 1];
  for (int i = 0; i <= kRings; ++i) {
    for (int j = 0; j <= kSectors; ++j) {
      if (j == kSectors) {
        corners[i][j] = corners[i][0];
        continue;
      }
      const double polar = std::numbers::pi * i / kRings;
      const double around = 2.0 * std::numbers::pi * j / kSectors;
      const double r = radius * rng.uniform(0.75, 1.15);
      const Eigen::Vector3d direction(std::sin(polar) * std::cos(around), -std::cos(polar),
                                      std::sin(polar) * std::sin(around));
      corners[i][j] = mesh.add_vertex(centre + r * direction, {radius * around, radius * polar});
    }
  }
  for (int i = 0; i < kRings; ++i) {
    for (int j = 0; j < kSectors; ++j)
      mesh.add_quad(corners[i][j], corners[i][j + 1], corners[i + 1][j + 1], corners[i + 1][j]);
  }
}

}  // namespace

void add_trees(Meshes& meshes, const RoadSurface& surface, const WorldOptions& options, Rng& rng) {
  if (options.trees_a_side_m <= 0.0) return;
  const double end = surface.path().length_m() + 2.0 * RoadSurface::reach_m();
  int variant = 0;
  for (const double side : {-1.0, 1.0}) {
    for (double s = -0.5 * RoadSurface::reach_m(); s < end; s += options.trees_a_side_m * rng.uniform(0.4, 1.6)) {
      const double aside = surface.profile().half_width_m + rng.uniform(0.8, 0.9 + surface.profile().pavement_m);
      const Footing foot = footing(surface, s, side * aside);
      const double trunk_height = rng.uniform(2.4, 3.5);
      const double trunk_radius = rng.uniform(0.1, 0.25);
      const double crown_radius = rng.uniform(1.2, 2.2);
      Rng own(rng.next());
      if (!clear_of_roads(surface, {foot.origin}, 0.5)) continue;
      TriangleMesh trunk;
      trunk.material = material_code(Material::kBark, ++variant);
      constexpr int kSides = 8;
      for (int k = 0; k < kSides; ++k) {
        const double a = 2.0 * std::numbers::pi * k / kSides;
        const double b = 2.0 * std::numbers::pi * (k + 1) / kSides;
        add_wall(trunk, foot.at(trunk_radius * std::cos(a), 0.0, trunk_radius * std::sin(a)),
                 foot.at(trunk_radius * std::cos(b), 0.0, trunk_radius * std::sin(b)), -0.3, trunk_height + 0.5);
      }
      TriangleMesh leaves;
      leaves.material = material_code(Material::kLeaves, variant);
      for (int k = 0; k < 4; ++k) {
        add_crown(leaves, foot.at(own.uniform(-0.8, 0.8), trunk_height + own.uniform(0.8, 2.2), own.uniform(-0.8, 0.8)),
                  crown_radius * own.uniform(0.6, 1.0), own);
      }
      meshes.push_back(std::move(trunk));
      meshes.push_back(std::move(leaves));
    }
  }
}

}  // namespace groundscale
