#include "groundscale/simulation/street_furniture.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "groundscale/simulation/material.hpp"

namespace groundscale {
namespace {

/// @param foot  `right` leads away from the road.
Meshes lamp_meshes(const Footing& foot, int variant, Rng& rng) {
  TriangleMesh metal = mesh_of(material_code(Material::kMetal, variant));
  const double height = rng.uniform(5.0, 8.0);
  const double arm = rng.uniform(0.5, 1.6);
  const Eigen::Vector3d top = foot.at(0.0, height, 0.0);
  add_tube(metal, {foot.at(0.0, -0.3, 0.0), foot.at(0.0, 1.0, 0.0), 0.09, 0.08, 8});
  add_tube(metal, {foot.at(0.0, 1.0, 0.0), top, 0.06, 0.045, 8});
  add_tube(metal, {top, foot.at(-arm, height + 0.2, 0.0), 0.04, 0.03, 5});
  add_box(metal, foot, {{-arm - 0.5, height + 0.14, -0.11}, {-arm + 0.1, height + 0.28, 0.11}});
  Meshes parts;
  parts.push_back(std::move(metal));
  return parts;
}

/// Round or rectangular signs on a post, towards the traffic of their side.
Meshes sign_meshes(const Footing& foot, int variant, Rng& rng) {
  TriangleMesh metal = mesh_of(material_code(Material::kMetal, variant));
  const double height = rng.uniform(2.4, 3.4);
  add_tube(metal, {foot.at(0.0, -0.3, 0.0), foot.at(0.0, height, 0.0), 0.035, 0.035, 6});
  const bool round = rng.uniform() < 0.6;
  TriangleMesh face = mesh_of(material_code(round ? Material::kSign : Material::kPlate, variant));
  constexpr double kBeforeM = -0.05;
  constexpr double kRadiusM = 0.3;
  if (round) {
    add_disc(face, {foot.at(0.0, height - kRadiusM, kBeforeM), foot.right, foot.up, kRadiusM, 14});
  } else {
    const double half = rng.uniform(0.2, 0.45);
    const double low = height - rng.uniform(0.25, 0.5);
    add_panel(face, {foot.at(-half, low, kBeforeM), foot.at(half, low, kBeforeM), foot.at(half, height, kBeforeM),
                     foot.at(-half, height, kBeforeM)});
  }
  Meshes parts;
  parts.push_back(std::move(metal));
  parts.push_back(std::move(face));
  return parts;
}

Meshes cabinet_meshes(const Footing& foot, int variant, const Eigen::Vector3d& half, double height) {
  TriangleMesh body = mesh_of(material_code(Material::kTrim, variant));
  TriangleMesh lid = mesh_of(material_code(Material::kMetal, variant));
  add_box(body, foot, {{-half.x(), -0.2, -half.z()}, {half.x(), height - 0.06, half.z()}});
  add_box(lid, foot, {{-half.x() - 0.03, height - 0.06, -half.z() - 0.03}, {half.x() + 0.03, height, half.z() + 0.03}});
  // A door's seam.
  add_box(lid, foot, {{-half.x() - 0.008, 0.15, -0.01}, {-half.x(), height - 0.1, 0.01}});
  Meshes parts;
  parts.push_back(std::move(body));
  parts.push_back(std::move(lid));
  return parts;
}

/// Where to put something small, `right` away from the road; nothing where a road or something else is.
bool find_place(Roadside& roadside, Footing& foot, double side, double half_m) {
  foot.right *= side;
  return roadside.clear_of_roads({foot.origin}, 0.3) && roadside.taken.take(foot, half_m, half_m);
}

}  // namespace

void add_poles(Roadside& roadside) {
  const double spacing = roadside.options.poles_a_side_m;
  if (spacing <= 0.0) return;
  Rng rng = roadside.generator(4);
  const double kerb = roadside.surface.profile().half_width_m + roadside.surface.profile().kerb_width_m;
  int variant = 0;
  for (const double side : {-1.0, 1.0}) {
    for (double s = roadside.begin_m; s < roadside.end_m; s += spacing * rng.uniform(0.5, 1.5)) {
      Rng own(rng.next());
      ++variant;
      const bool lamp = own.uniform() < 0.45;
      Footing foot = roadside.footing(s, side * (kerb + own.uniform(0.35, 0.6)));
      constexpr double kHalfM = 0.15;
      if (!find_place(roadside, foot, side, kHalfM)) continue;
      if (side < 0.0 && !lamp) {
        foot.along = -foot.along;
      }
      append(roadside.meshes, lamp ? lamp_meshes(foot, variant, own) : sign_meshes(foot, variant, own));
    }
  }
}

void add_boxes(Roadside& roadside) {
  const double spacing = roadside.options.boxes_a_side_m;
  if (spacing <= 0.0) return;
  Rng rng = roadside.generator(5);
  int variant = 500;
  for (const double side : {-1.0, 1.0}) {
    for (double s = roadside.begin_m; s < roadside.end_m; s += spacing * rng.uniform(0.3, 1.7)) {
      Rng own(rng.next());
      ++variant;
      const bool bin = own.uniform() < 0.6;
      const double half_along = bin ? 0.29 : own.uniform(0.35, 0.7);
      const double half_aside = bin ? 0.3 : own.uniform(0.17, 0.25);
      const double height = own.uniform(0.95, 1.3);
      Footing foot = roadside.footing(s, side * (roadside.pavement_end_m() - half_aside - own.uniform(0.02, 0.15)));
      if (!find_place(roadside, foot, side, half_along)) continue;
      append(roadside.meshes, cabinet_meshes(foot, variant, {half_aside, 0.0, half_along}, height));
    }
  }
}

}  // namespace groundscale
