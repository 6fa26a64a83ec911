#include "groundscale/simulation/fronts.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "groundscale/simulation/material.hpp"

namespace groundscale {
namespace {

enum class FrontKind { kHedge, kWall, kFence };

struct Front {
  FrontKind kind = FrontKind::kHedge;
  double height_m = 1.0;
  double half_thick_m = 0.1;
  int variant = 0;
};

std::optional<Front> random_front(const Lot& lot, const WorldOptions& options, Rng& rng) {
  const double share = rng.uniform();
  Front front;
  front.variant = lot.number;
  if (share < options.hedges_share) {
    front.kind = FrontKind::kHedge;
    front.height_m = rng.uniform(0.8, 1.8);
    front.half_thick_m = rng.uniform(0.25, 0.4);
  } else if (share < options.hedges_share + options.walls_share) {
    front.kind = FrontKind::kWall;
    front.height_m = rng.uniform(0.6, 1.3);
    front.half_thick_m = 0.13;
  } else if (share < options.hedges_share + options.walls_share + options.fences_share) {
    front.kind = FrontKind::kFence;
    front.height_m = rng.uniform(0.8, 1.3);
    front.half_thick_m = 0.06;
  } else {
    return std::nullopt;
  }
  return front;
}

/// An uneven surface over a section that goes up, across the top and down again.
void add_hedge(TriangleMesh& leaves, const Footing& foot, double length, const Front& front, Rng& rng) {
  constexpr double kStepM = 0.3;
  constexpr int kCorners = 8;
  const double h = front.height_m;
  const double w = front.half_thick_m;
  const double section[kCorners][2] = {{-w, -0.2},   {-1.05 * w, 0.4 * h}, {-w, 0.85 * h},      {-0.5 * w, h},
                                       {0.5 * w, h}, {w, 0.85 * h},        {1.05 * w, 0.4 * h}, {w, -0.2}};
  const int steps = std::max(1, static_cast<int>(std::lround(length / kStepM)));
  std::uint32_t last[kCorners] = {};
  for (int i = 0; i <= steps; ++i) {
    const double along = length * i / steps;
    double around = 0.0;
    for (int k = 0; k < kCorners; ++k) {
      constexpr double kUnevenM = 0.055;
      const double up = section[k][1] + (k > 0 && k + 1 < kCorners ? kUnevenM * rng.normal() : 0.0);
      const Eigen::Vector3d place =
          foot.at(section[k][0] + kUnevenM * rng.normal(), up, along + kUnevenM * rng.normal());
      const std::uint32_t corner = leaves.add_vertex(place, {along, around});
      if (i > 0 && k > 0) leaves.add_quad(last[k - 1], last[k], corner, corner - 1);
      if (k > 0) last[k - 1] = corner - 1;
      if (k == kCorners - 1) last[k] = corner;
      if (k + 1 < kCorners) around += std::hypot(section[k + 1][0] - section[k][0], section[k + 1][1] - section[k][1]);
    }
    if (i == 0 || i == steps) {
      const std::uint32_t first = last[0];
      for (int k = 1; k + 1 < kCorners; ++k) leaves.faces.push_back({first, last[k], last[k + 1]});
    }
  }
}

void add_garden_wall(TriangleMesh& stone, const Footing& foot, double length, const Front& front) {
  const double w = front.half_thick_m;
  add_box(stone, foot, {{-w, -0.3, 0.0}, {w, front.height_m - 0.08, length}});
  add_box(stone, foot, {{-w - 0.04, front.height_m - 0.08, 0.0}, {w + 0.04, front.height_m, length}});
}

/// Posts, two rails and pales.
void add_fence(TriangleMesh& wood, const Footing& foot, double length, const Front& front) {
  const double h = front.height_m;
  add_box(wood, foot, {{-0.06, -0.3, 0.0}, {0.06, h + 0.08, 0.12}});
  for (const double up : {0.2 * h, 0.85 * h}) {
    add_box(wood, foot, {{-0.02, up - 0.04, 0.0}, {0.02, up + 0.04, length}});
  }
  constexpr double kPaleM = 0.09;
  constexpr double kPitchM = 0.17;
  for (double along = 0.16; along + kPaleM < length; along += kPitchM) {
    // Upwards first: the grain runs that way.
    add_panel(wood, {foot.at(-0.03, 0.05, along), foot.at(-0.03, h, along), foot.at(-0.03, h, along + kPaleM),
                     foot.at(-0.03, 0.05, along + kPaleM)});
  }
}

/// A straight piece between two places on the path, on the ground at both ends.
void add_piece(Roadside& roadside, const Lot& lot, const Front& front, double from_m, double to_m, Rng& rng) {
  const double aside = lot.side * (roadside.pavement_end_m() + 0.2 + front.half_thick_m);
  const Footing from = roadside.footing(from_m, aside);
  const Footing to = roadside.footing(to_m, aside);
  const double length = (to.origin - from.origin).norm();
  constexpr double kLeastM = 0.3;
  if (length < kLeastM || !roadside.clear_of_roads({from.origin, to.origin}, 1.0)) return;
  Footing foot = from;
  foot.along = (to.origin - from.origin) / length;
  foot.right = lot.side * from.right;
  Footing middle = foot;
  middle.origin = 0.5 * (from.origin + to.origin);
  if (!roadside.taken.take(middle, 0.5 * length - 0.05, front.half_thick_m)) return;
  TriangleMesh mesh;
  switch (front.kind) {
    case FrontKind::kHedge:
      mesh = mesh_of(material_code(Material::kLeaves, front.variant));
      add_hedge(mesh, foot, length, front, rng);
      break;
    case FrontKind::kWall:
      mesh = mesh_of(material_code(Material::kStone, front.variant));
      add_garden_wall(mesh, foot, length, front);
      break;
    case FrontKind::kFence:
      mesh = mesh_of(material_code(Material::kWood, front.variant));
      add_fence(mesh, foot, length, front);
      break;
  }
  roadside.meshes.push_back(std::move(mesh));
}

}  // namespace

void add_fronts(Roadside& roadside, const std::vector<Lot>& lots) {
  for (const Lot& lot : lots) {
    Rng rng(lot.seed + 2);
    const std::optional<Front> front = random_front(lot, roadside.options, rng);
    constexpr double kGardenM = 1.0;
    if (!front || lot.front_m < roadside.pavement_end_m() + kGardenM) continue;
    // A gate before the house, and often a drive beside it.
    const double end = lot.begin_m + lot.width_m + lot.gap_m;
    const double gate = lot.begin_m + lot.width_m * rng.uniform(0.3, 0.7);
    const bool has_drive = lot.gap_m > 3.0 && rng.uniform() < 0.6;
    const double last = has_drive ? lot.begin_m + lot.width_m : end;
    constexpr double kHalfGateM = 0.6;
    constexpr double kPieceM = 2.6;
    const std::pair<double, double> stretches[] = {{lot.begin_m + 0.1, gate - kHalfGateM},
                                                   {gate + kHalfGateM, last - 0.1}};
    for (const auto& [begin, stop] : stretches) {
      const int pieces = std::max(1, static_cast<int>(std::ceil((stop - begin) / kPieceM)));
      const double step = (stop - begin) / pieces;
      for (int k = 0; k < pieces; ++k) {
        Rng own(rng.next());
        add_piece(roadside, lot, *front, begin + k * step, begin + (k + 1) * step, own);
      }
    }
  }
}

}  // namespace groundscale
