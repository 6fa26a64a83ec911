#pragma once

#include "groundscale/core/rng.hpp"
#include "groundscale/simulation/shapes.hpp"
#include "groundscale/simulation/world.hpp"

namespace groundscale {

/// Boxes with a gabled roof along both sides.
void add_houses(Meshes& meshes, const RoadSurface& surface, const WorldOptions& options, Rng& rng);

}  // namespace groundscale
