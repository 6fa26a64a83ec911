#include "groundscale/simulation/facade.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "groundscale/simulation/material.hpp"

namespace groundscale {
namespace {

constexpr double kBelowM = -1.5;  // walls go into sloping ground

/// A hole in a wall: from its left to its right, from low to high.
struct Opening {
  double left, right, low, high;
};

void add_wall_piece(TriangleMesh& mesh, const Footing& foot, const Opening& piece) {
  if (piece.right - piece.left < 1e-6 || piece.high - piece.low < 1e-6) return;
  add_panel(mesh,
            {foot.at(piece.left, piece.low, 0.0), foot.at(piece.right, piece.low, 0.0),
             foot.at(piece.right, piece.high, 0.0), foot.at(piece.left, piece.high, 0.0)},
            {piece.left, piece.low});
}

void add_window(HouseParts& parts, const Footing& foot, const Opening& o, bool shutters) {
  constexpr double kRevealM = 0.14;
  const auto reveal = [&](double right_a, double up_a, double right_b, double up_b) {
    add_panel(parts.walls,
              {foot.at(right_a, up_a, 0.0), foot.at(right_b, up_b, 0.0), foot.at(right_b, up_b, kRevealM),
               foot.at(right_a, up_a, kRevealM)},
              {0.0, 2.0});
  };
  reveal(o.left, o.low, o.left, o.high);
  reveal(o.left, o.high, o.right, o.high);
  reveal(o.right, o.high, o.right, o.low);
  // The pane: uv as the material wants it.
  TriangleMesh& panes = parts.windows;
  const double u = 2.0 * parts.window_count++;
  panes.add_quad(panes.add_vertex(foot.at(o.left, o.low, kRevealM), {u, 0.0}),
                 panes.add_vertex(foot.at(o.right, o.low, kRevealM), {u + 1.0, 0.0}),
                 panes.add_vertex(foot.at(o.right, o.high, kRevealM), {u + 1.0, 1.0}),
                 panes.add_vertex(foot.at(o.left, o.high, kRevealM), {u, 1.0}));
  add_box(parts.trim, foot, {{o.left - 0.08, o.low - 0.07, -0.09}, {o.right + 0.08, o.low, kRevealM}});
  if (!shutters) return;
  const double wide = 0.5 * (o.right - o.left);
  for (const double left : {o.left - wide - 0.03, o.right + 0.03}) {
    add_box(parts.wood, foot, {{left, o.low, -0.07}, {left + wide, o.high, -0.02}});
  }
}

/// A leaf under a small roof, with steps.
void add_door(HouseParts& parts, const Footing& foot, double middle, const HouseLook& look) {
  const double floor = look.ground_floor_m;
  const double left = middle - 0.55;
  const double right = middle + 0.55;
  add_box(parts.trim, foot, {{left - 0.12, floor, -0.04}, {right + 0.12, floor + 2.25, 0.02}});
  add_box(parts.wood, foot, {{left, floor, -0.06}, {right, floor + 2.1, 0.0}});
  add_box(parts.roof, foot, {{left - 0.4, floor + 2.4, -1.0}, {right + 0.4, floor + 2.52, 0.0}});
  for (double up = 0.0; up < floor; up += 0.17) {
    add_box(parts.trim, foot, {{left - 0.3, -0.5, -0.3 - (floor - up) * 1.6}, {right + 0.3, up, 0.0}});
  }
}

void add_balcony(HouseParts& parts, const Footing& foot, const Opening& o) {
  constexpr double kDeepM = 1.2;
  const double left = o.left - 0.7;
  const double right = o.right + 0.7;
  const double floor = o.low - 0.05;
  add_box(parts.trim, foot, {{left, floor - 0.16, -kDeepM}, {right, floor, 0.0}});
  constexpr double kRailM = 0.95;
  const auto rail = [&](double from_right, double from_along, double to_right, double to_along) {
    add_panel(parts.wood,
              {foot.at(from_right, floor + 0.08, from_along), foot.at(to_right, floor + 0.08, to_along),
               foot.at(to_right, floor + kRailM, to_along), foot.at(from_right, floor + kRailM, from_along)});
  };
  rail(left, 0.0, left, -kDeepM);
  rail(left, -kDeepM, right, -kDeepM);
  rail(right, -kDeepM, right, 0.0);
  add_box(parts.metal, foot, {{left, floor + kRailM, -kDeepM - 0.03}, {right, floor + kRailM + 0.06, -kDeepM + 0.03}});
}

}  // namespace

HouseParts::HouseParts(const HouseLook& look)
    : walls(mesh_of(material_code(Material::kFacade, look.variant))),
      windows(mesh_of(material_code(Material::kWindow, look.variant))),
      trim(mesh_of(material_code(Material::kTrim, look.variant))),
      wood(mesh_of(material_code(Material::kWood, look.variant))),
      roof(mesh_of(material_code(Material::kRoof, look.variant))),
      metal(mesh_of(material_code(Material::kMetal, look.variant))) {}

Meshes HouseParts::take() {
  Meshes meshes;
  for (TriangleMesh* mesh : {&walls, &windows, &trim, &wood, &roof, &metal}) meshes.push_back(std::move(*mesh));
  return meshes;
}

void add_facade(HouseParts& parts, const Wall& wall, const HouseLook& look, Rng& rng) {
  constexpr double kCornerM = 0.5;
  const int columns = wall.has_windows ? static_cast<int>((wall.length_m - 2.0 * kCornerM) / look.spacing_m) : 0;
  const auto whole = [&](double low, double high) {
    add_wall_piece(parts.walls, wall.foot, {0.0, wall.length_m, low, high});
  };
  if (columns == 0) return whole(kBelowM, look.eaves_m());
  const int door = wall.has_door ? rng.index(columns) : -1;
  const int balcony = look.balconies ? rng.index(columns) : -1;
  const double pitch = wall.length_m / columns;
  double built = kBelowM;
  for (int storey = 0; storey < look.storeys; ++storey) {
    const double floor = look.ground_floor_m + storey * look.storey_m;
    const double low = floor + look.sill_m;
    const double high = std::min(low + look.window_height_m, floor + look.storey_m - 0.25);
    whole(built, low);
    double left = 0.0;
    for (int column = 0; column < columns; ++column) {
      const double middle = (column + 0.5) * pitch;
      if (storey == 0 && column == door) {
        add_door(parts, wall.foot, middle, look);
        continue;
      }
      const Opening opening{middle - 0.5 * look.window_m, middle + 0.5 * look.window_m, low, high};
      add_wall_piece(parts.walls, wall.foot, {left, opening.left, low, high});
      add_window(parts, wall.foot, opening, look.shutters);
      if (storey > 0 && column == balcony) {
        add_balcony(parts, wall.foot, {opening.left, opening.right, floor, high});
      }
      left = opening.right;
    }
    add_wall_piece(parts.walls, wall.foot, {left, wall.length_m, low, high});
    built = high;
  }
  whole(built, look.eaves_m());
}

}  // namespace groundscale
