#include "groundscale/simulation/shapes.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "groundscale/core/check.hpp"

namespace groundscale {
namespace {

Eigen::Vector3d random_direction(Rng& rng) {
  const double up = rng.uniform(-1.0, 1.0);
  const double around = rng.uniform(0.0, 2.0 * std::numbers::pi);
  const double level = std::sqrt(1.0 - up * up);
  return {level * std::cos(around), up, level * std::sin(around)};
}

}  // namespace

void add_panel(TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& corners, const Eigen::Vector2d& uv) {
  GS_CHECK(corners.size() == 4, "a panel has four corners");
  const double width = (corners[1] - corners[0]).norm();
  const double height = (corners[3] - corners[0]).norm();
  const std::uint32_t a = mesh.add_vertex(corners[0], uv);
  const std::uint32_t b = mesh.add_vertex(corners[1], uv + Eigen::Vector2d(width, 0.0));
  const std::uint32_t c = mesh.add_vertex(corners[2], uv + Eigen::Vector2d(width, height));
  const std::uint32_t d = mesh.add_vertex(corners[3], uv + Eigen::Vector2d(0.0, height));
  mesh.add_quad(a, b, c, d);
}

void add_wall(TriangleMesh& mesh, const Eigen::Vector3d& from, const Eigen::Vector3d& to, double bottom_m,
              double top_m) {
  const Eigen::Vector3d up = -Eigen::Vector3d::UnitY();
  add_panel(mesh, {from + bottom_m * up, to + bottom_m * up, to + top_m * up, from + top_m * up}, {0.0, bottom_m});
}

void add_box(TriangleMesh& mesh, const Footing& foot, const Box& box) {
  const auto corner = [&](bool right, bool up, bool along) {
    return foot.at(right ? box.high.x() : box.low.x(), up ? box.high.y() : box.low.y(),
                   along ? box.high.z() : box.low.z());
  };
  const auto side = [&](bool right_a, bool along_a, bool right_b, bool along_b) {
    add_panel(mesh, {corner(right_a, false, along_a), corner(right_b, false, along_b), corner(right_b, true, along_b),
                     corner(right_a, true, along_a)});
  };
  side(false, false, true, false);
  side(true, false, true, true);
  side(true, true, false, true);
  side(false, true, false, false);
  for (const bool up : {false, true}) {
    add_panel(mesh,
              {corner(false, up, false), corner(true, up, false), corner(true, up, true), corner(false, up, true)});
  }
}

void add_tube(TriangleMesh& mesh, const Tube& tube) {
  const Eigen::Vector3d axis = tube.to - tube.from;
  const Eigen::Vector3d across = axis.unitOrthogonal();
  const Eigen::Vector3d other = axis.normalized().cross(across);
  std::uint32_t first_low = 0;
  std::uint32_t first_high = 0;
  std::uint32_t low = 0;
  std::uint32_t high = 0;
  for (int k = 0; k < tube.sides; ++k) {
    const double around = 2.0 * std::numbers::pi * k / tube.sides;
    const Eigen::Vector3d out = std::cos(around) * across + std::sin(around) * other;
    const double u = around * tube.from_radius_m;
    const std::uint32_t next_low = mesh.add_vertex(tube.from + tube.from_radius_m * out, {u, 0.0});
    const std::uint32_t next_high = mesh.add_vertex(tube.to + tube.to_radius_m * out, {u, axis.norm()});
    if (k == 0) {
      first_low = next_low;
      first_high = next_high;
    } else {
      mesh.add_quad(low, next_low, next_high, high);
    }
    low = next_low;
    high = next_high;
  }
  mesh.add_quad(low, first_low, first_high, high);
}

void add_disc(TriangleMesh& mesh, const Disc& disc) {
  const std::uint32_t middle = mesh.add_vertex(disc.middle, {0.0, 0.0});
  std::uint32_t first = 0;
  std::uint32_t last = 0;
  for (int k = 0; k < disc.sides; ++k) {
    const double around = 2.0 * std::numbers::pi * k / disc.sides;
    const Eigen::Vector2d at = disc.radius_m * Eigen::Vector2d(std::cos(around), std::sin(around));
    const std::uint32_t next = mesh.add_vertex(disc.middle + at.x() * disc.across + at.y() * disc.up, at);
    if (k == 0) {
      first = next;
    } else {
      mesh.faces.push_back({middle, last, next});
    }
    last = next;
  }
  mesh.faces.push_back({middle, last, first});
}

void add_leaves(TriangleMesh& mesh, const LeafLump& lump, Rng& rng) {
  for (int k = 0; k < lump.leaves; ++k) {
    // More of them outside than within.
    const Eigen::Vector3d offset = std::sqrt(rng.uniform()) * random_direction(rng);
    const Eigen::Vector3d middle = lump.middle + lump.radii.cwiseProduct(offset);
    const Eigen::Vector3d normal = random_direction(rng);
    const double size = lump.leaf_m * rng.uniform(0.6, 1.4);
    const Eigen::Vector3d length = size * normal.unitOrthogonal();
    const Eigen::Vector3d width = rng.uniform(0.5, 0.9) * normal.cross(length);
    const Eigen::Vector3d fold = rng.uniform(-0.4, 0.4) * size * normal;
    const Eigen::Vector2d uv(rng.uniform(0.0, 50.0), rng.uniform(0.0, 50.0));
    const std::uint32_t base = mesh.add_vertex(middle - length, uv);
    const std::uint32_t right = mesh.add_vertex(middle + width + fold, uv + Eigen::Vector2d(size, -size));
    const std::uint32_t tip = mesh.add_vertex(middle + length, uv + Eigen::Vector2d(2.0 * size, 0.0));
    const std::uint32_t left = mesh.add_vertex(middle - width + fold, uv + Eigen::Vector2d(size, size));
    mesh.add_quad(base, right, tip, left);
  }
}

TriangleMesh mesh_of(int material_code) {
  TriangleMesh mesh;
  mesh.material = material_code;
  return mesh;
}

void append(Meshes& meshes, Meshes&& parts) {
  for (TriangleMesh& part : parts) {
    if (!part.faces.empty()) meshes.push_back(std::move(part));
  }
}

int triangles_of(const Meshes& meshes) {
  std::size_t count = 0;
  for (const TriangleMesh& mesh : meshes) count += mesh.faces.size();
  return static_cast<int>(count);
}

}  // namespace groundscale
