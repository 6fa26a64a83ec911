#pragma once

#include <span>

#include "groundscale/geometry/rigid_transform.hpp"

namespace groundscale {

/// Turning of a drive in degrees, counted in pieces of 10 m; those of less than 3 degrees are left out, so that noise
/// and lane keeping don't add up to turns.
/// @param world_from_cam  In metres.
double turned_deg(std::span<const RigidTransform> world_from_cam);

}  // namespace groundscale
