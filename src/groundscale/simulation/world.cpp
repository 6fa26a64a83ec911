#include "groundscale/simulation/world.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "groundscale/simulation/roadside.hpp"

namespace groundscale {
namespace {

/// A strip of ground along the path between two distances from the crest.
TriangleMesh ground_strip(const RoadSurface& surface, Material material, double from_m, double to_m) {
  TriangleMesh mesh;
  mesh.material = material_code(material, 0);
  constexpr double kStepM = 0.5;
  const double begin = -RoadSurface::reach_m();
  const double end = surface.path().length_m() + 3.0 * RoadSurface::reach_m();
  const auto vertex = [&](double s, double from_crest) {
    const PathPoint point = surface.path().at(s);
    // On the inner side of a turn a strip must not reach beyond the circle's middle.
    constexpr double kShare = 0.9;
    double aside = from_crest - surface.profile().lane_offset_m;
    if (point.curvature_per_m * aside > kShare) aside = kShare / point.curvature_per_m;
    Eigen::Vector3d position = point.position + aside * point.right();
    position.y() = surface.ground_y(position.x(), position.z());
    const bool own = std::abs(surface.locate(position.x(), position.z()).on_path.distance_m - s) < 1.0;
    return std::pair(mesh.add_vertex(position, {s, from_crest}), own);
  };
  auto [left, left_own] = vertex(begin, from_m);
  auto [right, right_own] = vertex(begin, to_m);
  for (double s = begin + kStepM; s <= end; s += kStepM) {
    const auto [next_left, next_left_own] = vertex(s, from_m);
    const auto [next_right, next_right_own] = vertex(s, to_m);
    // What another pass has made already isn't made again.
    if (left_own || right_own || next_left_own || next_right_own) mesh.add_quad(left, right, next_right, next_left);
    left = next_left;
    right = next_right;
    left_own = next_left_own;
    right_own = next_right_own;
  }
  return mesh;
}

void add_ground(Meshes& meshes, const RoadSurface& surface) {
  const RoadProfile& p = surface.profile();
  const double pavement = p.half_width_m + p.kerb_width_m + p.pavement_m;
  const double verge = pavement + p.verge_m;
  const auto both_sides = [&](Material material, double from, double to) {
    meshes.push_back(ground_strip(surface, material, from, to));
    meshes.push_back(ground_strip(surface, material, -to, -from));
  };
  both_sides(Material::kAsphalt, 0.0, p.half_width_m);
  if (p.kerb_m > 0.0) {
    both_sides(Material::kKerb, p.half_width_m, p.half_width_m + p.kerb_face_m);
    both_sides(Material::kKerb, p.half_width_m + p.kerb_face_m, p.half_width_m + p.kerb_width_m);
  } else {
    both_sides(Material::kGrass, p.half_width_m, p.half_width_m + p.kerb_width_m);
  }
  both_sides(p.kerb_m > 0.0 ? Material::kPavement : Material::kGrass, p.half_width_m + p.kerb_width_m, pavement);
  both_sides(Material::kGrass, pavement, verge);
  both_sides(Material::kGrass, verge, RoadSurface::reach_m() - 1.0);
}

}  // namespace

WorldOptions WorldOptions::bare() {
  WorldOptions options;
  options.houses_share = 0.0;
  options.hedges_share = 0.0;
  options.walls_share = 0.0;
  options.fences_share = 0.0;
  options.trees_a_side_m = 0.0;
  options.bushes_a_side_m = 0.0;
  options.poles_a_side_m = 0.0;
  options.boxes_a_side_m = 0.0;
  options.cars_share = 0.0;
  return options;
}

Eigen::Vector3d World::sun() const {
  constexpr double kRadPerDeg = std::numbers::pi / 180.0;
  const double elevation = options.sun_elevation_deg * kRadPerDeg;
  const double azimuth = options.sun_azimuth_deg * kRadPerDeg;
  return {std::cos(elevation) * std::sin(azimuth), -std::sin(elevation), std::cos(elevation) * std::cos(azimuth)};
}

World make_world(const Path& path, const WorldOptions& options) {
  RoadSurface surface(path, options.profile);
  Meshes meshes;
  add_ground(meshes, surface);
  TakenGround taken;
  Roadside roadside{.surface = surface,
                    .options = options,
                    .path = surface.path(),
                    .lane_offset_m = options.profile.lane_offset_m,
                    .begin_m = -0.5 * RoadSurface::reach_m(),
                    .end_m = surface.path().length_m() + 2.0 * RoadSurface::reach_m(),
                    .taken = taken,
                    .meshes = meshes};
  add_roadside(roadside);
  return {options, std::move(surface), RayScene(std::move(meshes))};
}

}  // namespace groundscale
