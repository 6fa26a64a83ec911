#include "groundscale/simulation/world.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "groundscale/simulation/roadside.hpp"

namespace groundscale {
namespace {

/// A strip of ground along a road between two distances from its crest. What another pass of the path or another road
/// has made already isn't made again. `junction` takes what lies in junctions, which has no markings.
class GroundStrip {
 public:
  GroundStrip(const RoadSurface& surface, int road, double from_m, double to_m)
      : surface_(surface), road_(road), from_m_(from_m), to_m_(to_m) {}

  void add_to(TriangleMesh& open, TriangleMesh& junction) const {
    constexpr double kStepM = 0.5;
    const Path& path = surface_.roads()[static_cast<std::size_t>(road_)];
    const double begin = road_ == 0 ? -RoadSurface::lead_m() : 0.0;
    const double end = path.length_m() + (road_ == 0 ? RoadSurface::tail_m() : 0.0);
    Corner left = corner(begin, from_m_);
    Corner right = corner(begin, to_m_);
    for (double s = begin + kStepM; s <= end; s += kStepM) {
      const Corner next_left = corner(s, from_m_);
      const Corner next_right = corner(s, to_m_);
      if (left.own || right.own || next_left.own || next_right.own) {
        TriangleMesh& mesh = left.junction || right.junction ? junction : open;
        mesh.add_quad(mesh.add_vertex(left.position, left.uv), mesh.add_vertex(right.position, right.uv),
                      mesh.add_vertex(next_right.position, next_right.uv),
                      mesh.add_vertex(next_left.position, next_left.uv));
      }
      left = next_left;
      right = next_right;
    }
  }

 private:
  struct Corner {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Vector2d uv = Eigen::Vector2d::Zero();
    bool own = false;
    bool junction = false;
  };

  Corner corner(double s, double from_crest) const {
    const PathPoint point = surface_.roads()[static_cast<std::size_t>(road_)].at(s);
    // On the inner side of a turn a strip must not reach beyond the circle's middle.
    constexpr double kShare = 0.9;
    double aside = from_crest - surface_.profile().lane_offset_m;
    if (point.curvature_per_m * aside > kShare) aside = kShare / point.curvature_per_m;
    Corner corner;
    corner.position = point.position + aside * point.right();
    const RoadPlace place = surface_.locate(corner.position.x(), corner.position.z());
    corner.position.y() = place.ground_y;
    corner.uv = {s, from_crest};
    corner.own = place.road == road_ && std::abs(place.on_path.distance_m - s) < 1.0;
    corner.junction = place.junction;
    return corner;
  }

  const RoadSurface& surface_;
  int road_;
  double from_m_;
  double to_m_;
};

void add_ground(Meshes& meshes, const RoadSurface& surface) {
  const RoadProfile& p = surface.profile();
  const double pavement = p.half_width_m + p.kerb_width_m + p.pavement_m;
  const double verge = pavement + p.verge_m;
  const auto both_sides = [&](Material material, double from, double to) {
    TriangleMesh open;
    TriangleMesh junction;
    open.material = material_code(material, 0);
    junction.material = material_code(material, material == Material::kAsphalt ? 1 : 0);
    for (int road = 0; road < static_cast<int>(surface.roads().size()); ++road) {
      GroundStrip(surface, road, from, to).add_to(open, junction);
      GroundStrip(surface, road, -to, -from).add_to(open, junction);
    }
    meshes.push_back(std::move(open));
    meshes.push_back(std::move(junction));
  };
  // Fine enough for the roadway's roughness.
  constexpr double kLaneStripM = 0.45;
  const int strips = static_cast<int>(std::ceil(p.half_width_m / kLaneStripM));
  for (int k = 0; k < strips; ++k) {
    both_sides(Material::kAsphalt, p.half_width_m * k / strips, p.half_width_m * (k + 1) / strips);
  }
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

/// Grass under and about all of it, a little lower, so that there is ground wherever one looks.
TriangleMesh country(const RoadSurface& surface) {
  constexpr double kCellM = 6.0;
  constexpr double kBelowM = 0.4;
  constexpr double kAboutM = 150.0;
  Eigen::AlignedBox3d box;
  for (const Path& road : surface.roads()) {
    for (double s = 0.0; s <= road.length_m(); s += kCellM) box.extend(road.at(s).position);
  }
  const auto columns = static_cast<std::uint32_t>((box.sizes().x() + 2.0 * kAboutM) / kCellM) + 2;
  const auto rows = static_cast<std::uint32_t>((box.sizes().z() + 2.0 * kAboutM) / kCellM) + 2;
  TriangleMesh mesh;
  mesh.material = material_code(Material::kGrass, 0);
  const double lowest = box.max().y();
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      const double x = box.min().x() - kAboutM + kCellM * column;
      const double z = box.min().z() - kAboutM + kCellM * row;
      const RoadPlace place = surface.locate(x, z);
      const bool known = std::abs(place.from_crest_m) < RoadSurface::reach_m();
      mesh.add_vertex({x, (known ? place.ground_y : lowest) + kBelowM, z}, {x, z});
    }
  }
  for (std::uint32_t row = 0; row + 1 < rows; ++row) {
    for (std::uint32_t column = 0; column + 1 < columns; ++column) {
      const std::uint32_t corner = row * columns + column;
      mesh.add_quad(corner, corner + 1, corner + columns + 1, corner + columns);
    }
  }
  return mesh;
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
  RoadSurface surface(path, options.profile, options.side_roads ? side_roads_of(path) : std::vector<Path>{});
  Meshes meshes;
  add_ground(meshes, surface);
  meshes.push_back(country(surface));
  TakenGround taken;
  Roadside roadside{.surface = surface,
                    .options = options,
                    .path = surface.path(),
                    .begin_m = -0.5 * RoadSurface::reach_m(),
                    .end_m = surface.path().length_m() + 2.0 * RoadSurface::reach_m(),
                    .taken = taken,
                    .meshes = meshes};
  add_roadside(roadside);
  for (std::size_t road = 1; road < surface.roads().size(); ++road) {
    const Path& side_road = surface.roads()[road];
    // Other houses than beside the driven path.
    WorldOptions own = options;
    own.seed += 0x9e3779b97f4a7c15ULL * road;
    Roadside beside{surface, own, side_road, 0.0, side_road.length_m(), taken, meshes};
    add_roadside(beside);
  }
  return {options, std::move(surface), RayScene(std::move(meshes))};
}

}  // namespace groundscale
