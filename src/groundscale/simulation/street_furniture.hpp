#pragma once

#include "groundscale/simulation/roadside.hpp"

namespace groundscale {

/// Street lamps and posts with signs.
void add_poles(Roadside& roadside);

/// Cabinets and bins.
void add_boxes(Roadside& roadside);

}  // namespace groundscale
