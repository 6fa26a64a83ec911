#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/mapping/batch_adjustment.hpp"
#include "groundscale/mapping/drive_tracks.hpp"

namespace groundscale::internal {

/// A track's point from its own sights, in the world. Nothing where it has fewer than three, too little parallax, or
/// fits too badly.
std::optional<Eigen::Vector3d> point_of(const DriveTracks::Track& track,
                                        const std::vector<RigidTransform>& cam_from_world, const Camera& camera,
                                        const BatchOptions& options);

}  // namespace groundscale::internal
