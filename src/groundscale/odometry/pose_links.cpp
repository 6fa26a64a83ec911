#include "groundscale/odometry/pose_links.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "groundscale/core/check.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

RigidTransform in_metres(RigidTransform transform, double unit_m) {
  transform.translation *= unit_m;
  return transform;
}

}  // namespace

void enter_link(const PoseLink& link, FrameResult& result) {
  const Eigen::Vector3d& translation = link.reference_from_cam.translation;
  result.reference = link.reference;
  result.reference_from_cam = link.reference_from_cam.rotation;
  result.direction_in_reference.setZero();
  if (translation.norm() > 0.0) result.direction_in_reference = translation.normalized();
}

void PoseLinks::begin_map(const Keyframe& first, const RigidTransform& world_from_cam_m) {
  keyframes_m_.clear();
  keyframes_m_[first.serial] = world_from_cam_m;
}

void PoseLinks::place_keyframes(const LocalMap& map) {
  const auto& keyframes = map.keyframes();
  for (std::size_t k = 1; k < keyframes.size(); ++k) {
    PoseLink& link = links_[static_cast<std::size_t>(keyframes[k].frame)];
    const RigidTransform before_from_cam = keyframes[k - 1].cam_from_world * keyframes[k].cam_from_world.inverse();
    if (link.is_keyframe) link.reference_from_cam = before_from_cam;
    keyframes_m_[keyframes[k].serial] =
        keyframes_m_.at(keyframes[k - 1].serial) * in_metres(before_from_cam, link.unit_m);
  }
  keyframes_m_.erase(keyframes_m_.begin(), keyframes_m_.lower_bound(keyframes.front().serial));
}

RigidTransform PoseLinks::latest_pose_m(const LocalMap& map) const {
  const PoseLink& link = links_.back();
  const auto& keyframes = map.keyframes();
  const auto reference = std::find_if(keyframes.begin(), keyframes.end(),
                                      [&link](const Keyframe& keyframe) { return keyframe.frame == link.reference; });
  GS_CHECK(reference != keyframes.end(), "a frame hangs on a keyframe of the map");
  return keyframes_m_.at(reference->serial) * in_metres(link.reference_from_cam, link.unit_m);
}

std::vector<RigidTransform> PoseLinks::poses_m(std::span<const MapScaleFilter::Smoothed> smoothed) const {
  GS_CHECK(smoothed.empty() || smoothed.size() == links_.size(), "a scale for each frame, or none");
  // The keyframe after each frame that hangs on the same one. Two maps may have begun at a keyframe: the nearer counts.
  std::vector<int> next_of(links_.size(), -1);
  std::vector<int> next_keyframe(links_.size(), -1);
  for (std::size_t k = links_.size(); k-- > 0;) {
    if (links_[k].reference < 0) continue;
    int& next = next_keyframe[static_cast<std::size_t>(links_[k].reference)];
    next_of[k] = next;
    if (links_[k].is_keyframe) next = static_cast<int>(k);
  }
  std::vector<RigidTransform> poses;
  poses.reserve(links_.size());
  for (std::size_t k = 0; k < links_.size(); ++k) {
    const PoseLink& link = links_[k];
    if (link.reference < 0) {
      poses.emplace_back();
      continue;
    }
    const double unit_m = link.by_map && !smoothed.empty() ? std::exp(smoothed[k].log_scale) : link.unit_m;
    poses.push_back(poses[static_cast<std::size_t>(link.reference)] * in_metres(final_link(link, next_of[k]), unit_m));
  }
  return poses;
}

RigidTransform PoseLinks::final_link(const PoseLink& link, int next) const {
  if (!link.by_map || link.is_keyframe || next < 0) return link.reference_from_cam;
  const RigidTransform& before = links_[static_cast<std::size_t>(next)].as_tracked;
  const RigidTransform& after = links_[static_cast<std::size_t>(next)].reference_from_cam;
  const double length_before = before.translation.norm();
  const double length_after = after.translation.norm();
  const double along = link.reference_from_cam.translation.norm();
  constexpr double kLeastShare = 1e-3;  // of its own way, below it says nothing
  if (!(length_before > kLeastShare * along) || !(length_after > 0.0)) return link.reference_from_cam;
  const Eigen::Vector3d axis = before.translation.cross(after.translation) / (length_before * length_after);
  const double share = std::min(1.0, along / length_before);
  RigidTransform followed;
  followed.rotation =
      exp_so3(share * log_so3(after.rotation * before.rotation.transpose())) * link.reference_from_cam.rotation;
  followed.translation =
      length_after / length_before * (exp_so3(axis) * link.reference_from_cam.translation);  // a small angle
  return followed;
}

}  // namespace groundscale
