#include "groundscale/odometry/bridge.hpp"

#include <algorithm>
#include <utility>

#include "groundscale/core/check.hpp"

namespace groundscale {

Bridge::Bridge(const CameraSetup& setup, const OdometryOptions& options, PairwiseOdometry pairwise)
    : setup_(setup),
      options_(options),
      detector_(pairwise.shared_detector()),
      speed_(pairwise.shared_speed()),
      pairwise_(std::make_unique<PairwiseOdometry>(std::move(pairwise))) {
  // A later stretch shares them, and doesn't open them again.
  options_.road.network.file.clear();
  options_.scale.speed.file.clear();
}

const FrameResult& Bridge::advance(const TrackedFrame& present) {
  frames_.push_back(present.index);
  return pairwise_->advance(present.frame, present.road_mask, present.tracked);
}

void Bridge::restart(const Mounting& mounting, const std::deque<TrackedFrame>& recent,
                     const std::vector<FrameResult>& results) {
  CameraSetup setup = setup_;
  setup.pitch_rad = mounting.pitch_rad;
  setup.roll_rad = mounting.roll_rad;
  setup.yaw_rad = mounting.yaw_rad;
  auto pairwise = PairwiseOdometry::create(setup, options_);
  GS_CHECK(pairwise.has_value(), "what could be created once can be created again");
  pairwise_ = std::make_unique<PairwiseOdometry>(std::move(*pairwise));
  pairwise_->share_detector(detector_);
  pairwise_->share_speed(speed_);
  frames_.clear();
  constexpr std::size_t kReplayed = 4;
  auto seen = recent.end() - static_cast<std::ptrdiff_t>(std::min(recent.size(), kReplayed));
  double replayed_units = 0.0;
  double replayed_m = 0.0;
  const int present = static_cast<int>(results.size());
  for (int k = seen == recent.end() ? present : seen->index; k < present; ++k) {
    const FrameResult& known = results[static_cast<std::size_t>(k)];
    if (seen != recent.end() && seen->index == k) {
      pairwise_->advance(seen->frame, seen->road_mask, seen->tracked);
      ++seen;
    } else if (known.state != FrameState::kStill) {
      pairwise_->advance({known.frame, known.time_s, {}, known.reason}, {}, {});
    } else {
      continue;  // nothing has moved
    }
    if (!frames_.empty()) {
      replayed_units += pairwise_->results().back().online_step_m;
      replayed_m += known.online_step_m;
    }
    frames_.push_back(k);
  }
  unit_m_ = replayed_units > 0.0 ? replayed_m / replayed_units : 1.0;
}

RigidTransform Bridge::in_metres(RigidTransform transform) const {
  if (!pairwise_->scaled()) transform.translation *= unit_m_;
  return transform;
}

RigidTransform Bridge::latest_step() const {
  const std::vector<RigidTransform>& poses = pairwise_->online_poses();
  if (poses.size() < 2) return {};
  return in_metres(poses[poses.size() - 2].inverse() * poses.back());
}

std::vector<RigidTransform> Bridge::final_steps() {
  pairwise_->finish();
  const std::vector<RigidTransform> poses = pairwise_->final_poses();
  std::vector<RigidTransform> steps(poses.size());
  for (std::size_t k = 1; k < poses.size(); ++k) steps[k] = in_metres(poses[k - 1].inverse() * poses[k]);
  return steps;
}

}  // namespace groundscale
