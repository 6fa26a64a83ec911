#include "groundscale/odometry/pose_chain.hpp"

#include <cmath>

#include "groundscale/core/check.hpp"

namespace groundscale {

RigidTransform place(const FrameResult& link, const RigidTransform& world_from_reference,
                     const RigidTransform& world_from_previous, double step_m) {
  RigidTransform pose;
  pose.rotation = world_from_reference.rotation * link.reference_from_cam;
  const Eigen::Vector3d direction = world_from_reference.rotation * link.direction_in_reference;
  if (direction.isZero()) {
    pose.translation = world_from_previous.translation;
    return pose;
  }
  const Eigen::Vector3d previous = world_from_previous.translation - world_from_reference.translation;
  const double along = previous.dot(direction);
  const double beside_squared = std::max(0.0, previous.squaredNorm() - along * along);
  const double distance = along + std::sqrt(std::max(0.0, step_m * step_m - beside_squared));
  pose.translation = world_from_reference.translation + distance * direction;
  return pose;
}

std::vector<RigidTransform> chain_poses(const std::vector<FrameResult>& results, const std::vector<double>& steps_m) {
  GS_CHECK(results.size() == steps_m.size(), "a step for each frame");
  std::vector<RigidTransform> poses;
  poses.reserve(results.size());
  for (std::size_t k = 0; k < results.size(); ++k) {
    const int reference = results[k].reference;
    GS_CHECK(reference < static_cast<int>(k), "a link leads to an earlier frame");
    poses.push_back(reference < 0
                        ? RigidTransform{}
                        : place(results[k], poses[static_cast<std::size_t>(reference)], poses[k - 1], steps_m[k]));
  }
  return poses;
}

}  // namespace groundscale
