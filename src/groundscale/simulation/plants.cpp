#include "groundscale/simulation/plants.hpp"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "groundscale/simulation/material.hpp"

namespace groundscale {
namespace {

/// Branches that rise from the trunk's top and bend upwards; where leaves sit on them.
std::vector<Eigen::Vector3d> add_branches(TriangleMesh& wood, const Footing& foot, const Tube& trunk, double reach_m,
                                          Rng& rng) {
  std::vector<Eigen::Vector3d> places;
  const int count = 4 + rng.index(3);
  for (int k = 0; k < count; ++k) {
    const double around = 2.0 * std::numbers::pi * (k + rng.uniform(-0.3, 0.3)) / count;
    const Eigen::Vector3d out = std::cos(around) * foot.right + std::sin(around) * foot.along;
    const double first = reach_m * rng.uniform(0.4, 0.6);
    const double second = reach_m * rng.uniform(0.35, 0.55);
    const Eigen::Vector3d from = trunk.to + rng.uniform(-0.5, 0.0) * foot.up;
    const Eigen::Vector3d bend = from + first * (0.75 * out + rng.uniform(0.5, 0.8) * foot.up);
    const Eigen::Vector3d tip = bend + second * (0.55 * out + rng.uniform(0.6, 1.1) * foot.up);
    const double radius = trunk.to_radius_m * rng.uniform(0.45, 0.65);
    add_tube(wood, {from, bend, radius, 0.6 * radius, 4});
    add_tube(wood, {bend, tip, 0.6 * radius, 0.015, 4});
    places.push_back(bend + 0.35 * (tip - bend));
    places.push_back(tip);
  }
  places.push_back(trunk.to + reach_m * rng.uniform(0.8, 1.1) * foot.up);
  return places;
}

}  // namespace

Meshes tree_meshes(const Footing& foot, int variant, Rng& rng) {
  TriangleMesh wood = mesh_of(material_code(Material::kBark, variant));
  TriangleMesh leaves = mesh_of(material_code(Material::kLeaves, variant));
  const double height = rng.uniform(2.2, 3.2);
  const double radius = rng.uniform(0.09, 0.2);
  const double reach = rng.uniform(1.6, 2.9);
  const Eigen::Vector3d top = foot.at(rng.uniform(-0.25, 0.25), height, rng.uniform(-0.25, 0.25));
  const Tube trunk{foot.at(0.0, -0.3, 0.0), top, 1.25 * radius, 0.8 * radius, 8};
  add_tube(wood, trunk);
  const std::vector<Eigen::Vector3d> places = add_branches(wood, foot, trunk, reach, rng);
  constexpr int kLeaves = 420;
  const int each = kLeaves / static_cast<int>(places.size());
  for (const Eigen::Vector3d& place : places) {
    const double size = reach * rng.uniform(0.32, 0.52);
    const Eigen::Vector3d radii(size * rng.uniform(0.9, 1.3), size * rng.uniform(0.6, 0.9),
                                size * rng.uniform(0.9, 1.3));
    add_leaves(leaves, {place, radii, each, 0.08 * reach + 0.03}, rng);
  }
  Meshes parts;
  parts.push_back(std::move(wood));
  parts.push_back(std::move(leaves));
  return parts;
}

Meshes bush_meshes(const Footing& foot, int variant, Rng& rng) {
  TriangleMesh leaves = mesh_of(material_code(Material::kLeaves, variant));
  const double height = rng.uniform(0.5, 1.7);
  const double radius = rng.uniform(0.35, 0.85);
  constexpr int kLumps = 3;
  for (int k = 0; k < kLumps; ++k) {
    const Eigen::Vector3d middle =
        foot.at(0.5 * radius * rng.normal(), height * rng.uniform(0.35, 0.6), 0.5 * radius * rng.normal());
    add_leaves(leaves, {middle, {0.7 * radius, 0.5 * height, 0.7 * radius}, 60, 0.05 + 0.08 * radius}, rng);
  }
  Meshes parts;
  parts.push_back(std::move(leaves));
  return parts;
}

void add_trees(Roadside& roadside) {
  const double spacing = roadside.options.trees_a_side_m;
  if (spacing <= 0.0) return;
  Rng rng = roadside.generator(2);
  const RoadProfile& profile = roadside.surface.profile();
  int variant = 0;
  for (const double side : {-1.0, 1.0}) {
    for (double s = roadside.begin_m; s < roadside.end_m; s += spacing * rng.uniform(0.4, 1.6)) {
      Rng own(rng.next());
      ++variant;
      // Between the parked cars, or behind the pavement.
      const bool at_kerb = own.uniform() < 0.5;
      const double aside =
          at_kerb ? profile.half_width_m + own.uniform(0.6, 1.0) : roadside.pavement_end_m() + own.uniform(-0.2, 0.6);
      const Footing foot = roadside.footing(s, side * aside);
      constexpr double kHalfM = 0.3;
      if (!roadside.clear_of_roads({foot.origin}, 0.5) || !roadside.taken.take(foot, kHalfM, kHalfM)) continue;
      append(roadside.meshes, tree_meshes(foot, variant, own));
    }
  }
}

void add_bushes(Roadside& roadside) {
  const double spacing = roadside.options.bushes_a_side_m;
  if (spacing <= 0.0) return;
  Rng rng = roadside.generator(7);
  int variant = 1000;
  for (const double side : {-1.0, 1.0}) {
    for (double s = roadside.begin_m; s < roadside.end_m; s += spacing * rng.uniform(0.1, 1.9)) {
      Rng own(rng.next());
      ++variant;
      const Footing foot = roadside.footing(s, side * (roadside.pavement_end_m() + own.uniform(0.5, 4.0)));
      constexpr double kHalfM = 0.5;
      if (!roadside.clear_of_roads({foot.origin}, 1.5) || !roadside.taken.take(foot, kHalfM, kHalfM)) continue;
      append(roadside.meshes, bush_meshes(foot, variant, own));
    }
  }
}

}  // namespace groundscale
