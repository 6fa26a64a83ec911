#include "groundscale/odometry/map_trail.hpp"

#include <algorithm>

#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

/// From one frame to another, above 0.
double time_between(double earlier_s, double later_s) {
  constexpr double kMinStepTimeS = 1e-3;
  return std::max(kMinStepTimeS, later_s - earlier_s);
}

/// A motion carried out to a share of it, or beyond it: turn and translation apart.
RigidTransform share_of(const RigidTransform& motion, double share) {
  return {exp_so3(share * log_so3(motion.rotation)), share * motion.translation};
}

}  // namespace

void MapTrail::add(int index, double time_s, const RigidTransform& cam_from_world) {
  frames_.push_back({index, time_s, cam_from_world});
}

const RigidTransform& MapTrail::add(int index, double time_s, const RigidTransform& cam_from_world,
                                    const Keyframe& keyframe) {
  frames_.push_back(
      {index, time_s, cam_from_world, keyframe.serial, cam_from_world * keyframe.cam_from_world.inverse()});
  return frames_.back().cam_from_keyframe;
}

void MapTrail::hang_latest_on_itself(int serial) {
  frames_.back().keyframe = serial;
  frames_.back().cam_from_keyframe = {};
}

RigidTransform MapTrail::predicted_pose(double time_s) const {
  const Frame& last = frames_.back();
  if (frames_.size() < 2) return last.cam_from_world;
  const Frame& before = frames_[frames_.size() - 2];
  const RigidTransform step = last.cam_from_world * before.cam_from_world.inverse();
  const double share = time_between(last.time_s, time_s) / time_between(before.time_s, last.time_s);
  constexpr double kMostShare = 20.0;
  return share_of(step, std::min(share, kMostShare)) * last.cam_from_world;
}

RigidTransform MapTrail::pose_between(const RigidTransform& later_cam_from_world, double later_s, double time_s) const {
  const Frame& last = frames_.back();
  const double share = std::clamp((time_s - last.time_s) / time_between(last.time_s, later_s), 0.0, 1.0);
  return share_of(later_cam_from_world * last.cam_from_world.inverse(), share) * last.cam_from_world;
}

std::vector<RigidTransform> MapTrail::world_from_cam() const {
  std::vector<RigidTransform> poses;
  poses.reserve(frames_.size());
  for (const Frame& frame : frames_) poses.push_back(frame.cam_from_world.inverse());
  return poses;
}

void MapTrail::follow(const LocalMap& map) {
  for (Frame& frame : frames_) {
    const Keyframe* keyframe = frame.keyframe < 0 ? nullptr : map.find(frame.keyframe);
    if (keyframe != nullptr) frame.cam_from_world = frame.cam_from_keyframe * keyframe->cam_from_world;
  }
}

void MapTrail::scale(double lambda) {
  for (Frame& frame : frames_) frame.cam_from_keyframe.translation *= lambda;
}

void MapTrail::forget_after(int index) {
  while (frames_.size() > 1 && frames_.back().index > index) frames_.pop_back();
}

void MapTrail::forget_before(int index) {
  while (frames_.size() > 2 && frames_.front().index < index) frames_.pop_front();
}

void MapTrail::forget_behind(double distance_m, double unit_m) {
  const Eigen::Vector3d here = latest().cam_from_world.inverse().translation;
  while (frames_.size() > 3 &&
         unit_m * (frames_.front().cam_from_world.inverse().translation - here).norm() > distance_m) {
    frames_.pop_front();
  }
}

}  // namespace groundscale
