#include "groundscale/simulation/houses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "groundscale/simulation/facade.hpp"
#include "groundscale/simulation/material.hpp"

namespace groundscale {
namespace {

enum class RoofKind { kAlong, kAcross, kHipped, kFlat };

HouseLook random_look(const Lot& lot, Rng& rng) {
  HouseLook look;
  look.variant = lot.number;
  const double share = rng.uniform();
  look.storeys = share < 0.2 ? 1 : (share < 0.75 ? 2 : 3);
  look.ground_floor_m = rng.uniform(0.2, 0.9);
  look.storey_m = rng.uniform(2.6, 3.1);
  look.window_m = rng.uniform(0.9, 1.6);
  look.window_height_m = rng.uniform(1.2, 1.6);
  look.sill_m = rng.uniform(0.75, 1.0);
  look.shutters = rng.uniform() < 0.35;
  look.spacing_m = look.window_m * (look.shutters ? 2.3 : 1.6) + rng.uniform(0.2, 0.9);
  look.balconies = rng.uniform() < 0.3;
  return look;
}

/// A house from above: a rectangle with its middle, the front towards the road.
struct Plan {
  Footing middle;  ///< On the ground; `right` leads from the front to the back, `along` along the front.
  double width_m;  ///< Along the front.
  double depth_m;
};

/// The plan's four walls from outside: front, far end, back, near end.
std::array<Wall, 4> walls_of(const Plan& plan) {
  const double half_width = 0.5 * plan.width_m;
  const double half_depth = 0.5 * plan.depth_m;
  const Footing& m = plan.middle;
  const auto wall = [&](double right, double along, const Eigen::Vector3d& direction, const Eigen::Vector3d& inwards,
                        double length) {
    Wall made;
    made.foot.origin = m.at(right, 0.0, along);
    made.foot.right = direction;
    made.foot.along = inwards;
    made.length_m = length;
    return made;
  };
  return {wall(-half_depth, -half_width, m.along, m.right, plan.width_m),
          wall(-half_depth, half_width, m.right, -m.along, plan.depth_m),
          wall(half_depth, half_width, -m.along, -m.right, plan.width_m),
          wall(half_depth, -half_width, -m.right, m.along, plan.depth_m)};
}

/// A roof over a plan whose ridge runs along (or across) it; hips slope back from the ridge's ends.
void add_pitched_roof(HouseParts& parts, const Plan& plan, RoofKind kind, double eaves, double pitch) {
  Footing ridge_frame = plan.middle;
  double length = plan.width_m;
  double span = plan.depth_m;
  if (kind == RoofKind::kAcross) {
    std::swap(length, span);
    ridge_frame.along = plan.middle.right;
    ridge_frame.right = -plan.middle.along;
  }
  constexpr double kOverM = 0.4;  // beyond the walls
  const double half = 0.5 * length + kOverM;
  const double aside = 0.5 * span + kOverM;
  const double low = eaves - kOverM * pitch;
  const double top = eaves + 0.5 * span * pitch;
  const double hip = kind == RoofKind::kHipped ? std::min(0.9 * half, aside) : 0.0;
  for (const double side : {-1.0, 1.0}) {
    add_panel(parts.roof, {ridge_frame.at(side * aside, low, -half), ridge_frame.at(side * aside, low, half),
                           ridge_frame.at(0.0, top, half - hip), ridge_frame.at(0.0, top, hip - half)});
    add_tube(parts.metal, {ridge_frame.at(side * (aside + 0.05), low, -half),
                           ridge_frame.at(side * (aside + 0.05), low, half), 0.06, 0.06, 4});
    TriangleMesh& end = kind == RoofKind::kHipped ? parts.roof : parts.walls;
    const double out = kind == RoofKind::kHipped ? half : 0.5 * length;
    const double wide = kind == RoofKind::kHipped ? aside : 0.5 * span;
    const double foot = kind == RoofKind::kHipped ? low : eaves;
    end.faces.push_back({end.add_vertex(ridge_frame.at(-wide, foot, side * out), {0.0, foot}),
                         end.add_vertex(ridge_frame.at(wide, foot, side * out), {2.0 * wide, foot}),
                         end.add_vertex(ridge_frame.at(0.0, top, side * (out - hip)), {wide, top})});
  }
}

void add_chimney(HouseParts& parts, const Plan& plan, double top, Rng& rng) {
  const double along = 0.35 * plan.width_m * rng.uniform(-1.0, 1.0);
  const double right = 0.15 * plan.depth_m * rng.uniform(-1.0, 1.0);
  add_box(parts.walls, plan.middle, {{right - 0.3, top - 2.0, along - 0.4}, {right + 0.3, top + 0.8, along + 0.4}});
  add_box(parts.metal, plan.middle, {{right - 0.35, top + 0.8, along - 0.45}, {right + 0.35, top + 0.9, along + 0.45}});
}

/// Windows in little houses of their own on the roof towards the road.
void add_dormers(HouseParts& parts, const Plan& plan, double eaves, double pitch, Rng& rng) {
  const int count = 1 + rng.index(3);
  constexpr double kBackM = 0.7;  // behind the front wall
  const double front = -0.5 * plan.depth_m + kBackM;
  const double low = eaves + kBackM * pitch;
  for (int k = 0; k < count; ++k) {
    const double along = plan.width_m * ((k + 0.5) / count - 0.5);
    add_box(parts.walls, plan.middle, {{front, low - 0.3, along - 0.75}, {front + 2.0, low + 1.3, along + 0.75}});
    add_box(parts.roof, plan.middle, {{front - 0.3, low + 1.3, along - 0.95}, {front + 2.2, low + 1.42, along + 0.95}});
    const double u = 2.0 * parts.window_count++;
    TriangleMesh& panes = parts.windows;
    const auto corner = [&](double to_right, double up, double u_at, double v_at) {
      return panes.add_vertex(plan.middle.at(front - 0.02, low + up, along + to_right), {u_at, v_at});
    };
    panes.add_quad(corner(-0.5, 0.1, u, 0.0), corner(0.5, 0.1, u + 1.0, 0.0), corner(0.5, 1.2, u + 1.0, 1.0),
                   corner(-0.5, 1.2, u, 1.0));
  }
}

void add_roof(HouseParts& parts, const Plan& plan, const HouseLook& look, Rng& rng) {
  const double share = rng.uniform();
  const RoofKind kind = share < 0.45   ? RoofKind::kAlong
                        : share < 0.65 ? RoofKind::kAcross
                        : share < 0.9  ? RoofKind::kHipped
                                       : RoofKind::kFlat;
  const double eaves = look.eaves_m();
  const double pitch = rng.uniform(0.55, 1.1);
  const bool dormers = rng.uniform() < 0.5;
  if (kind == RoofKind::kFlat) {
    const double half_depth = 0.5 * plan.depth_m + 0.2;
    const double half_width = 0.5 * plan.width_m + 0.2;
    add_box(parts.trim, plan.middle, {{-half_depth, eaves, -half_width}, {half_depth, eaves + 0.35, half_width}});
    return;
  }
  add_pitched_roof(parts, plan, kind, eaves, pitch);
  const double span = kind == RoofKind::kAcross ? plan.width_m : plan.depth_m;
  add_chimney(parts, plan, eaves + 0.5 * span * pitch, rng);
  if (dormers && kind == RoofKind::kAlong) add_dormers(parts, plan, eaves, pitch, rng);
}

Footing middle_of(const Roadside& roadside, const Lot& lot) {
  Footing foot = roadside.footing(lot.begin_m + 0.5 * lot.width_m, lot.side * lot.front_m);
  foot.right *= lot.side;
  foot.origin += 0.5 * lot.depth_m * foot.right;
  return foot;
}

Meshes house_meshes(const Roadside& roadside, const Lot& lot) {
  Rng rng(lot.seed);
  const HouseLook look = random_look(lot, rng);
  const Plan plan{middle_of(roadside, lot), lot.width_m, lot.depth_m};
  HouseParts parts(look);
  std::array<Wall, 4> walls = walls_of(plan);
  constexpr double kViewM = 1.5;  // windows look at more than a neighbour's wall
  walls[0].has_windows = walls[0].has_door = true;
  walls[1].has_windows = lot.gap_m > kViewM;
  walls[3].has_windows = lot.before_m > kViewM;
  for (const Wall& wall : walls) {
    HouseLook own = look;
    own.balconies = look.balconies && wall.has_door;
    add_facade(parts, wall, own, rng);
  }
  add_roof(parts, plan, look, rng);
  // A downpipe at the front's corner.
  const Footing& front = walls[0].foot;
  add_tube(parts.metal, {front.at(0.15, -0.3, -0.07), front.at(0.15, look.eaves_m(), -0.07), 0.05, 0.05, 5});
  return parts.take();
}

}  // namespace

std::vector<Lot> lay_out_lots(Roadside& roadside) {
  Rng rng = roadside.generator(1);
  std::vector<Lot> lots;
  int number = 0;
  for (const double side : {-1.0, 1.0}) {
    double s = roadside.begin_m;
    double before = 0.0;
    while (s < roadside.end_m) {
      Lot lot;
      lot.side = side;
      lot.begin_m = s;
      lot.width_m = rng.uniform(8.0, 16.0);
      lot.depth_m = rng.uniform(8.0, 11.0);
      const bool at_pavement = rng.uniform() < 0.25;
      lot.front_m = roadside.pavement_end_m() + (at_pavement ? 0.1 : rng.uniform(1.5, 6.0));
      lot.gap_m = rng.uniform() < 0.35 ? 0.0 : rng.uniform(2.0, 8.0);
      lot.before_m = before;
      lot.seed = rng.next();
      lot.number = ++number;
      before = lot.gap_m;
      s += lot.width_m + lot.gap_m;
      const Footing middle = middle_of(roadside, lot);
      const double half_width = 0.5 * lot.width_m;
      const double half_depth = 0.5 * lot.depth_m;
      std::vector<Eigen::Vector3d> places;
      for (const double right : {-1.0, 0.0, 1.0}) {
        for (const double along : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
          places.push_back(middle.at(right * half_depth, 0.0, along * half_width));
        }
      }
      // Neighbours' corners may touch where the road bends a little.
      constexpr double kTouchM = 0.4;
      if (!roadside.clear_of_roads(places, roadside.surface.profile().pavement_m)) continue;
      if (roadside.taken.take(middle, half_width - kTouchM, half_depth - kTouchM)) lots.push_back(lot);
    }
  }
  return lots;
}

void add_houses(Roadside& roadside, const std::vector<Lot>& lots) {
  for (const Lot& lot : lots) {
    Rng rng(lot.seed + 1);
    if (rng.uniform() < roadside.options.houses_share) append(roadside.meshes, house_meshes(roadside, lot));
  }
}

}  // namespace groundscale
