#pragma once

#include "groundscale/core/rng.hpp"
#include "groundscale/simulation/roadside.hpp"
#include "groundscale/simulation/shapes.hpp"

namespace groundscale {

/// Trunk, branches, and leaves with gaps that light falls through; some 950 triangles in two meshes.
Meshes tree_meshes(const Footing& foot, int variant, Rng& rng);

/// Up to head height; some 360 triangles.
Meshes bush_meshes(const Footing& foot, int variant, Rng& rng);

/// Trees along both kerbs.
void add_trees(Roadside& roadside);

/// Bushes on the verge and in front of houses.
void add_bushes(Roadside& roadside);

}  // namespace groundscale
