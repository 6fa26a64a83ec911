#pragma once

#include <vector>

#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/odometry/frame_result.hpp"

namespace groundscale {

/// Pose of a frame that lies on the ray from its reference along the link's direction, `step_m` from the frame before:
/// d = a + sqrt(step^2 - c^2), where the frame before lies a along that ray and c beside it. Where the ray doesn't come
/// that near (step < c) the nearest point. Without a direction the camera stayed where the frame before was.
RigidTransform place(const FrameResult& link, const RigidTransform& world_from_reference,
                     const RigidTransform& world_from_previous, double step_m);

/// Poses of all frames from their links and steps; the first is the identity.
/// @param steps_m  As long as results; the first one counts for nothing.
std::vector<RigidTransform> chain_poses(const std::vector<FrameResult>& results, const std::vector<double>& steps_m);

}  // namespace groundscale
