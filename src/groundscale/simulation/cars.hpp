#pragma once

#include "groundscale/core/rng.hpp"
#include "groundscale/simulation/shapes.hpp"
#include "groundscale/simulation/world.hpp"

namespace groundscale {

/// Cars along both kerbs.
void add_parked_cars(Meshes& meshes, const RoadSurface& surface, const WorldOptions& options, Rng& rng);

}  // namespace groundscale
