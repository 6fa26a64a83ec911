#pragma once

#include <vector>

#include "groundscale/simulation/houses.hpp"
#include "groundscale/simulation/roadside.hpp"

namespace groundscale {

/// Hedges, garden walls and fences between pavement and front garden, with gaps for gates and drives.
void add_fronts(Roadside& roadside, const std::vector<Lot>& lots);

}  // namespace groundscale
