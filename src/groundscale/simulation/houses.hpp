#pragma once

#include <vector>

#include "groundscale/simulation/roadside.hpp"
#include "groundscale/simulation/shapes.hpp"

namespace groundscale {

/// A piece of frontage, whether or not a house stands on it.
struct Lot {
  double side = 1.0;      ///< 1: right of the road, -1: left.
  double begin_m = 0.0;   ///< Along the path, the house's; it goes on over `gap_m`.
  double width_m = 0.0;   ///< Of the house.
  double gap_m = 0.0;     ///< To the next one; 0 in a row.
  double before_m = 0.0;  ///< To the one before.
  double depth_m = 0.0;
  double front_m = 0.0;  ///< From the crest to the house's front.
  std::uint64_t seed = 0;
  int number = 0;
};

/// Lots along both sides, their houses' ground taken.
std::vector<Lot> lay_out_lots(Roadside& roadside);

/// Houses on a share of the lots: fronts with windows in reveals, doors, shutters, balconies; roofs, dormers, chimneys.
void add_houses(Roadside& roadside, const std::vector<Lot>& lots);

}  // namespace groundscale
