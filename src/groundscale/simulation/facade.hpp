#pragma once

#include "groundscale/core/rng.hpp"
#include "groundscale/simulation/shapes.hpp"

namespace groundscale {

/// What all walls of a house have in common.
struct HouseLook {
  int variant = 0;
  int storeys = 2;
  double ground_floor_m = 0.5;
  double storey_m = 2.8;
  double spacing_m = 2.8;  ///< Of windows.
  double window_m = 1.2;   ///< Its width.
  double window_height_m = 1.4;
  double sill_m = 0.9;
  bool shutters = false;
  bool balconies = false;

  double eaves_m() const { return ground_floor_m + storeys * storey_m; }
};

/// A house's meshes while it is built.
struct HouseParts {
  explicit HouseParts(const HouseLook& look);
  Meshes take();

  TriangleMesh walls, windows, trim, wood, roof, metal;
  int window_count = 0;
};

/// A wall seen from outside: its left lower corner on the ground is the footing's origin, `right` runs along it,
/// `along` into the house.
struct Wall {
  Footing foot;
  double length_m = 0.0;
  bool has_windows = false;
  bool has_door = false;
};

/// The wall from below the ground to the eaves, with windows set back into it.
void add_facade(HouseParts& parts, const Wall& wall, const HouseLook& look, Rng& rng);

}  // namespace groundscale
