#include "groundscale/simulation/world.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "groundscale/core/rng.hpp"

namespace groundscale {
namespace {

using Meshes = std::vector<TriangleMesh>;

/// A frame on the ground: where, and which way is along and to the right.
struct Footing {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d along = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d right = Eigen::Vector3d::UnitX();

  Eigen::Vector3d at(double right_m, double up_m, double along_m) const {
    return origin + right_m * right + along_m * along - up_m * Eigen::Vector3d::UnitY();
  }
};

/// Beside the path, `from_crest_m` to the right of the crest, on the ground.
Footing footing(const RoadSurface& surface, double distance_m, double from_crest_m) {
  const PathPoint point = surface.path().at(distance_m);
  Footing footing;
  footing.along = point.forward();
  footing.right = point.right();
  footing.origin = point.position + (from_crest_m - surface.profile().lane_offset_m) * footing.right;
  footing.origin.y() = surface.ground_y(footing.origin.x(), footing.origin.z());
  return footing;
}

/// Whether no road, of this pass or another, comes nearer than `clear_m` to any of the places.
bool clear_of_roads(const RoadSurface& surface, const std::vector<Eigen::Vector3d>& places, double clear_m) {
  return std::all_of(places.begin(), places.end(), [&](const Eigen::Vector3d& place) {
    return std::abs(surface.locate(place.x(), place.z()).from_crest_m) >= surface.profile().half_width_m + clear_m;
  });
}

/// A wall from one ground point to another, uv along it and up.
void add_wall(TriangleMesh& mesh, const Eigen::Vector3d& from, const Eigen::Vector3d& to, double bottom_m,
              double top_m) {
  const double length = (to - from).norm();
  const Eigen::Vector3d up = -Eigen::Vector3d::UnitY();
  mesh.add_quad(mesh.add_vertex(from + bottom_m * up, {0.0, bottom_m}),
                mesh.add_vertex(to + bottom_m * up, {length, bottom_m}),
                mesh.add_vertex(to + top_m * up, {length, top_m}), mesh.add_vertex(from + top_m * up, {0.0, top_m}));
}

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
  both_sides(Material::kAsphalt, 0.0, 0.5 * p.half_width_m);
  both_sides(Material::kAsphalt, 0.5 * p.half_width_m, p.half_width_m);
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

/// Boxes with a gabled roof along both sides.
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

}  // namespace

Eigen::Vector3d World::sun() const {
  constexpr double kRadPerDeg = std::numbers::pi / 180.0;
  const double elevation = options.sun_elevation_deg * kRadPerDeg;
  const double azimuth = options.sun_azimuth_deg * kRadPerDeg;
  return {std::cos(elevation) * std::sin(azimuth), -std::sin(elevation), std::cos(elevation) * std::cos(azimuth)};
}

World make_world(const Path& path, const WorldOptions& options) {
  RoadSurface surface(path, options.profile, options.side_roads ? side_roads_of(path) : std::vector<Path>{});
  Meshes meshes;
  Rng rng(options.seed);
  add_ground(meshes, surface);
  meshes.push_back(country(surface));
  add_houses(meshes, surface, options, rng);
  add_trees(meshes, surface, options, rng);
  add_parked_cars(meshes, surface, options, rng);
  return {options, std::move(surface), RayScene(std::move(meshes))};
}

}  // namespace groundscale
