#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "groundscale/odometry/pairwise.hpp"

namespace groundscale {

/// A frame as it was tracked, for what begins later.
struct TrackedFrame {
  Frame frame;
  Image road_mask;
  TrackedPoints tracked;
  int index = 0;  ///< Of its result.
};

/// Carries frames where there is no map: a stretch of the drive in the pairwise odometry, in metres by its own
/// measurement of the road or, until there is one, by what the map before it said of the same frames.
class Bridge {
 public:
  /// @param pairwise  Of the same camera and options, before its first frame.
  Bridge(const CameraSetup& setup, const OdometryOptions& options, PairwiseOdometry pairwise);

  /// The camera is another one in the stretches to come, in the same axes.
  void use_camera(CameraPtr camera) { setup_.camera = std::move(camera); }

  const FrameResult& advance(const TrackedFrame& present);
  /// A new stretch, which goes on from the last frames that a map has carried.
  /// @param recent   Latest frames with an image that moved.
  /// @param results  Of all frames so far.
  void restart(const Mounting& mounting, const std::deque<TrackedFrame>& recent,
               const std::vector<FrameResult>& results);

  const PairwiseOdometry& pairwise() const { return *pairwise_; }
  /// Whether the stretch has a measured scale of its own.
  bool scaled() const { return pairwise_->scaled(); }
  /// Frames of the stretch, ascending.
  const std::vector<int>& frames() const { return frames_; }
  /// world_from_cam of one of them, counted in the stretch, in the stretch's own world; from what was known by then.
  RigidTransform pose(std::size_t k) const { return in_metres(pairwise_->online_poses()[k]); }
  /// before_from_cam of the latest frame; the identity in the first one of a drive.
  RigidTransform latest_step() const;
  /// before_from_cam of the frames of the stretch, from all that it has seen; the identity in the first.
  std::vector<RigidTransform> final_steps();

 private:
  RigidTransform in_metres(RigidTransform transform) const;

  CameraSetup setup_;
  OdometryOptions options_;
  std::shared_ptr<RoadDetector> detector_;
  std::shared_ptr<SpeedReference> speed_;
  std::unique_ptr<PairwiseOdometry> pairwise_;
  std::vector<int> frames_;
  double unit_m_ = 1.0;  ///< Metres per unit of the pairwise odometry while it has no scale of its own.
};

}  // namespace groundscale
