#include "groundscale/simulation/houses.hpp"

#include <cmath>
#include <tuple>
#include <utility>

#include "groundscale/simulation/material.hpp"

namespace groundscale {

void add_houses(Meshes& meshes, const RoadSurface& surface, const WorldOptions& options, Rng& rng) {
  const double end = surface.path().length_m() + 2.0 * RoadSurface::reach_m();
  int variant = 0;
  for (const double side : {-1.0, 1.0}) {
    double s = -0.5 * RoadSurface::reach_m();
    while (s < end) {
      const double width = rng.uniform(7.0, 15.0);
      const double depth = rng.uniform(7.0, 11.0);
      const double height = rng.uniform(4.0, 10.0);
      const double front = surface.profile().half_width_m + surface.profile().pavement_m + rng.uniform(0.8, 5.0);
      const bool built = rng.uniform() < options.houses_share;
      const double gap = rng.uniform() < 0.5 ? 0.0 : rng.uniform(1.0, 6.0);
      const Footing foot = footing(surface, s + 0.5 * width, side * front);
      s += width + gap;
      ++variant;
      if (!built) continue;
      const Eigen::Vector3d corners[] = {foot.at(0.0, 0.0, -0.5 * width), foot.at(0.0, 0.0, 0.5 * width),
                                         foot.at(side * depth, 0.0, 0.5 * width),
                                         foot.at(side * depth, 0.0, -0.5 * width)};
      if (!clear_of_roads(surface,
                          {corners[0], corners[1], corners[2], corners[3], foot.at(side * 0.5 * depth, 0.0, 0.0)},
                          surface.profile().pavement_m)) {
        continue;
      }
      TriangleMesh walls;
      walls.material = material_code(Material::kFacade, variant);
      constexpr double kBelowM = -1.5;  // walls go into sloping ground
      for (int k = 0; k < 4; ++k) add_wall(walls, corners[k], corners[(k + 1) % 4], kBelowM, height);
      TriangleMesh roof;
      roof.material = material_code(Material::kRoof, variant);
      const double ridge = height + 0.45 * depth;
      const Eigen::Vector3d up = -Eigen::Vector3d::UnitY();
      const Eigen::Vector3d ridge_from = foot.at(side * 0.5 * depth, ridge, -0.5 * width);
      const Eigen::Vector3d ridge_to = foot.at(side * 0.5 * depth, ridge, 0.5 * width);
      const double slope = std::hypot(0.5 * depth, ridge - height);
      for (const int first : {0, 2}) {
        const Eigen::Vector3d from = corners[first] + height * up;
        const Eigen::Vector3d to = corners[first + 1] + height * up;
        roof.add_quad(roof.add_vertex(from, {0.0, 0.0}), roof.add_vertex(to, {width, 0.0}),
                      roof.add_vertex(first == 0 ? ridge_to : ridge_from, {width, slope}),
                      roof.add_vertex(first == 0 ? ridge_from : ridge_to, {0.0, slope}));
      }
      for (const auto& [a, b, top] : {std::tuple(1, 2, ridge_to), std::tuple(3, 0, ridge_from)}) {
        walls.faces.push_back({walls.add_vertex(corners[a] + height * up, {0.0, height}),
                               walls.add_vertex(corners[b] + height * up, {depth, height}),
                               walls.add_vertex(top, {0.5 * depth, ridge})});
      }
      meshes.push_back(std::move(walls));
      meshes.push_back(std::move(roof));
    }
  }
}

}  // namespace groundscale
