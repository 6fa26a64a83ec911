#pragma once

#include "groundscale/core/rng.hpp"
#include "groundscale/simulation/shapes.hpp"
#include "groundscale/simulation/world.hpp"

namespace groundscale {

/// Trees along both kerbs.
void add_trees(Meshes& meshes, const RoadSurface& surface, const WorldOptions& options, Rng& rng);

}  // namespace groundscale
