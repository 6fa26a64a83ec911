// How the keyframe odometry gets along without a map: frames carried by the pairwise odometry, a map begun and lost.
#include <algorithm>
#include <array>
#include <utility>

#include "groundscale/odometry/keyframe.hpp"

namespace groundscale {

const FrameResult& KeyframeOdometry::bridge(const TrackedFrame& present) {
  FrameResult result = bridge_.advance(present);
  clock_.lap("bridging");
  const RigidTransform step = bridge_.latest_step();
  links_.add({present.index - 1, step, 1.0, false, false});
  if (lost_.waiting()) {
    keeper_.pass(present.frame.time_s, 0.0);  // the map's scale still counts where it is found again
  } else {
    keeper_.skip();
  }
  append(std::move(result), online_poses_.empty() ? RigidTransform{} : online_poses_.back() * step);
  if (!scaled_ && bridge_.scaled()) adopt_bridge_scale();
  if (scaled_ && results_.back().state == FrameState::kMoving && start_map(present)) close_bridge();
  return results_.back();
}

/// The first measurement of a drive: all frames up to now become metres.
void KeyframeOdometry::adopt_bridge_scale() {
  scaled_ = true;
  for (std::size_t k = 0; k < results_.size(); ++k) {
    const RigidTransform pose = bridge_.pairwise().online_poses()[k];
    const FrameResult& measured = bridge_.pairwise().results()[k];
    results_[k].raw_over_online = measured.raw_over_online;
    results_[k].online_step_m = measured.online_step_m;
    results_[k].scaled = true;
    if (k > 0) links_[static_cast<int>(k)].reference_from_cam = online_poses_[k - 1].inverse() * pose;
    place(k, pose);
  }
}

/// The steps of the stretch that was bridged, from all that it has seen.
void KeyframeOdometry::close_bridge() {
  const std::vector<RigidTransform> steps = bridge_.final_steps();
  for (std::size_t k = 1; k < steps.size(); ++k) {
    PoseLink& link = links_[bridge_.frames()[k]];
    if (!link.by_map) link.reference_from_cam = steps[k];
  }
}

/// Whether a step since that frame is only a guess.
bool KeyframeOdometry::is_guessed_after(int index) const {
  return std::any_of(results_.begin() + index + 1, results_.end(), [](const FrameResult& result) {
    return result.state == FrameState::kBridged || result.state == FrameState::kLost;
  });
}

bool KeyframeOdometry::start_map(const TrackedFrame& present) {
  // The oldest view that still shares enough points: none has more parallax.
  const KeyframeOptions& options = options_.keyframe;
  const TrackedFrame* first = nullptr;
  const std::vector<int>& frames = bridge_.frames();
  std::size_t first_bridged = 0;
  std::vector<RayPair> rays;
  for (const TrackedFrame& candidate : recent_) {
    const auto bridged = std::lower_bound(frames.begin(), frames.end(), candidate.index);
    if (bridged == frames.end() || *bridged != candidate.index) continue;
    if (is_guessed_after(candidate.index)) continue;
    const Matches matches = match_by_id(candidate.tracked.points, present.tracked.points);
    if (static_cast<int>(matches.size()) < options.start_matches) continue;
    rays = ray_pairs(matches, *camera_);
    if (fit_rotation(rays, camera_->focal_px()).parallax_px < options.start_parallax_px) break;
    first = &candidate;
    first_bridged = static_cast<std::size_t>(bridged - frames.begin());
    break;
  }
  if (first == nullptr) return false;
  const RigidTransform present_from_first = bridge_.pose(frames.size() - 1).inverse() * bridge_.pose(first_bridged);
  RigidTransform guess = present_from_first;
  guess.translation.normalize();
  const TwoViewMotion motion = estimate_motion(rays, camera_->focal_px(), options_.motion, rng_, guess);
  if (motion.state != MotionState::kMoving) return false;
  RigidTransform metric = motion.cam2_from_cam1;
  metric.translation *= present_from_first.translation.norm();

  LocalMap map(camera_, options.map);
  const RigidTransform world_from_first = online_poses_.back() * metric;
  map.add(first->index, world_from_first.inverse(), first->tracked.points);
  const int serial = map.add(present.index, online_poses_.back().inverse(), present.tracked.points);
  map.triangulate();
  map.adjust();
  if (map.point_count() < options.start_points) return false;  // a map that is lost may still be found again
  map_ = std::move(map);
  lost_.forget();
  mapping_ = true;
  located_ = present.index;
  keeper_.start(1.0, options_.scale.filter.start_sd, hang_bridge_on(first->index, first_bridged));
  begin_trail();
  trail_.hang_latest_on_itself(serial);
  const Keyframe& a = map_.keyframes().front();
  const Keyframe& b = map_.keyframes().back();
  links_.begin_map(a, world_from_first);
  const RigidTransform link = a.cam_from_world * b.cam_from_world.inverse();
  links_.latest() = {first->index, link, 1.0, true, true, link};
  trail_.follow(map_);
  links_.place_keyframes(map_);
  place(online_poses_.size() - 1, links_.latest_pose_m(map_));
  const std::size_t before = online_poses_.size() - 2;  // a map has two views
  results_.back().online_step_m = (online_poses_.back().translation - online_poses_[before].translation).norm();
  halt_points_ = present.tracked.points;
  pending_correction_.reset();
  correction_open_ = false;
  road_.begin(bridge_.pairwise().mounting_estimate());
  clock_.lap("bridging");
  return true;
}

/// Frames that were bridged since a map's first view hang on it: what becomes of the map's scale reaches them too.
/// @param bridged  The first view, counted in the stretch. @return how many frames there are, the present one included.
int KeyframeOdometry::hang_bridge_on(int first, std::size_t bridged) {
  const std::vector<int>& frames = bridge_.frames();
  for (std::size_t k = bridged + 1; k + 1 < frames.size(); ++k) {
    if (links_[frames[k]].by_map) continue;  // of the map before
    const RigidTransform first_from_cam = bridge_.pose(bridged).inverse() * bridge_.pose(k);
    links_[frames[k]] = {first, first_from_cam, 1.0, true, false};
    enter_link(links_[frames[k]], results_[static_cast<std::size_t>(frames[k])]);
  }
  const int present = frames.back();
  int own = 1;
  const auto is_older = [this, first](int k) { return links_[k].by_map && links_[k].reference != first; };
  while (own < present - first && !is_older(present - own)) ++own;
  return own;
}

/// The way over the bridge, up to the present frame.
void KeyframeOdometry::begin_trail() {
  constexpr double kTrailM = 15.0;
  trail_.clear();
  const std::vector<int>& frames = bridge_.frames();
  std::size_t oldest = frames.size() - 1;
  const RigidTransform world_from_bridge = online_poses_.back() * bridge_.pose(oldest).inverse();
  const Eigen::Vector3d& here = online_poses_.back().translation;
  const auto pose_of = [&](std::size_t k) { return world_from_bridge * bridge_.pose(k); };
  while (oldest > 0 && (pose_of(oldest).translation - here).norm() < kTrailM) --oldest;
  for (std::size_t k = oldest; k < frames.size(); ++k) {
    const FrameResult& result = results_[static_cast<std::size_t>(frames[k])];
    trail_.add(frames[k], result.time_s, pose_of(k).inverse());
  }
}

/// The pairwise odometry goes on from the last frames that the map carried.
void KeyframeOdometry::lose_map(const TrackedFrame& present) {
  mapping_ = false;
  correction_open_ = false;
  refiner_.restart();
  lost_.wait(present.frame.time_s);
  road_.lose();
  bridge_.restart(road_.mounting().mounting(), recent_, results_);
}

/// Pose of a frame that has lost the map; the landmarks that it shows are followed again from here.
std::optional<RigidTransform> KeyframeOdometry::find_again(TrackedFrame& present, FrameResult& result) {
  if (mapping_) lost_.remember(map_, recent_, located_);
  // At the speed before, or at half of it, or at a halt.
  const double lost_s = present.frame.time_s - trail_.latest().time_s;
  const std::array guesses{trail_.predicted_pose(present.frame.time_s),
                           trail_.predicted_pose(present.frame.time_s - 0.5 * lost_s), trail_.latest().cam_from_world};
  const auto found = lost_.find(present, guesses, rng_);
  if (!found) return std::nullopt;
  tracker_.revive(found->sights);
  present.tracked = {tracker_.points(), tracker_.followed()};
  result.reason.clear();
  result.matches = static_cast<int>(found->sights.size());
  result.inliers = result.matches;
  result.rms_px = found->pose.rms_px;
  result.tracks = static_cast<int>(present.tracked.points.size());
  result.tracks_kept = present.tracked.followed;
  return found->pose.cam_from_world;
}

/// The map carries frames again: those since it was lost lie evenly between the last one that it located and this one.
void KeyframeOdometry::close_gap(const TrackedFrame& present, const RigidTransform& cam_from_world) {
  lost_.forget();
  mapping_ = true;
  trail_.forget_after(located_);
  const Keyframe& keyframe = map_.keyframes().back();
  for (int k = located_ + 1; k < present.index; ++k) {
    FrameResult& result = results_[static_cast<std::size_t>(k)];
    const RigidTransform pose = trail_.pose_between(cam_from_world, present.frame.time_s, result.time_s);
    links_[k] = {keyframe.frame, keyframe.cam_from_world * pose.inverse(), keeper_.held(), true, false};
    enter_link(links_[k], result);
  }
  located_ = present.index;
}

}  // namespace groundscale
