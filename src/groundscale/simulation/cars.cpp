#include "groundscale/simulation/cars.hpp"

#include <cmath>
#include <utility>

#include "groundscale/simulation/material.hpp"

namespace groundscale {
namespace {

/// A body and a cabin that narrows upwards.
void add_car(Meshes& meshes, const Footing& foot, int variant, Rng& rng) {
  const double length = rng.uniform(3.7, 4.7);
  constexpr double kHalfWidthM = 0.87;
  struct Ring {
    double up, half_width, front, back;
  };
  const Ring body[] = {{0.18, kHalfWidthM, 0.5 * length, -0.5 * length},
                       {0.85, kHalfWidthM, 0.48 * length, -0.49 * length}};
  const Ring cabin[] = {{0.85, 0.83, 0.2 * length, -0.42 * length}, {1.42, 0.62, 0.05 * length, -0.3 * length}};
  const auto corner = [&](const Ring& ring, int k) {
    const bool right = k == 1 || k == 2;
    const bool front = k >= 2;
    return foot.at(right ? ring.half_width : -ring.half_width, ring.up, front ? ring.front : ring.back);
  };
  const auto shell = [&](const Ring* rings, Material sides, Material top) {
    TriangleMesh mesh;
    mesh.material = material_code(sides, variant);
    TriangleMesh lid;
    lid.material = material_code(top, variant);
    for (int k = 0; k < 4; ++k) {
      const int next = (k + 1) % 4;
      mesh.add_quad(
          mesh.add_vertex(corner(rings[0], k), {0.0, 0.0}), mesh.add_vertex(corner(rings[0], next), {1.0, 0.0}),
          mesh.add_vertex(corner(rings[1], next), {1.0, 1.0}), mesh.add_vertex(corner(rings[1], k), {0.0, 1.0}));
    }
    lid.add_quad(lid.add_vertex(corner(rings[1], 0), {0.0, 0.0}), lid.add_vertex(corner(rings[1], 1), {1.0, 0.0}),
                 lid.add_vertex(corner(rings[1], 2), {1.0, 1.0}), lid.add_vertex(corner(rings[1], 3), {0.0, 1.0}));
    meshes.push_back(std::move(mesh));
    meshes.push_back(std::move(lid));
  };
  shell(body, Material::kPaint, Material::kPaint);
  shell(cabin, Material::kGlass, Material::kPaint);
}

}  // namespace

void add_parked_cars(Meshes& meshes, const RoadSurface& surface, const WorldOptions& options, Rng& rng) {
  const double end = surface.path().length_m() + RoadSurface::reach_m();
  constexpr double kPlaceM = 5.6;
  // Two wheels on the pavement, so that the lane stays free.
  const double aside = surface.profile().half_width_m + 0.5;
  int variant = 0;
  for (const double side : {-1.0, 1.0}) {
    for (double s = -0.5 * RoadSurface::reach_m(); s < end; s += kPlaceM) {
      const bool taken = rng.uniform() < options.cars_share;
      Rng own(rng.next());
      const Footing foot = footing(surface, s + own.uniform(-0.3, 0.3), side * aside);
      // Not in turns, and not where another pass of the road lies.
      constexpr double kStraightPerM = 0.02;
      if (!taken || std::abs(surface.path().at(s).curvature_per_m) > kStraightPerM) continue;
      if (!clear_of_roads(surface, {foot.at(0.0, 0.0, -2.5), foot.at(0.0, 0.0, 2.5)}, 0.3)) continue;
      add_car(meshes, foot, ++variant, own);
    }
  }
}

}  // namespace groundscale
