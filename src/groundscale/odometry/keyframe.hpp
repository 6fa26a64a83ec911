#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "groundscale/core/rng.hpp"
#include "groundscale/mapping/local_map.hpp"
#include "groundscale/mapping/resection.hpp"
#include "groundscale/odometry/bridge.hpp"
#include "groundscale/odometry/camera_refiner.hpp"
#include "groundscale/odometry/lost_map.hpp"
#include "groundscale/odometry/map_trail.hpp"
#include "groundscale/odometry/odometry.hpp"
#include "groundscale/odometry/pairwise.hpp"
#include "groundscale/odometry/pose_links.hpp"
#include "groundscale/odometry/road_follower.hpp"
#include "groundscale/scale/scale_keeper.hpp"
#include "groundscale/tracking/tracker.hpp"

namespace groundscale {

/// Keyframe odometry with local bundle adjustment, its scale held by the road: Algorithm 2 of Zhou, Dai, Li 2019.
///
/// The pairwise odometry carries frames until a map can be started, and wherever the map is lost. Deterministic for
/// given images, camera and options. Memory grows by about 1 kB a frame.
class KeyframeOdometry final : public Odometry {
 public:
  /// @return As PairwiseOdometry::create.
  static Result<std::unique_ptr<KeyframeOdometry>> create(const CameraSetup& setup, const OdometryOptions& options);

  const FrameResult& advance(const Frame& frame, const Image& road_mask) override;
  using Odometry::advance;
  void finish() override;

  const std::vector<FrameResult>& results() const override { return results_; }
  FrameDetails details() const override;
  bool scaled() const override { return scaled_; }
  const std::vector<RigidTransform>& online_poses() const override { return online_output_; }
  std::vector<RigidTransform> final_poses() const override { return final_poses_; }
  std::vector<ScaleEvent> corrections() const override { return corrections_; }
  std::vector<CameraEvent> camera_changes() const override { return refiner_.events(); }
  const std::vector<TrackPoint>& tracks() const override { return tracker_.points(); }
  const StageClock& clock() const override { return clock_; }
  const RoadDetector* road_detector() const override { return road_.detector(); }
  const SpeedReference* speed_reference() const override { return speed_.get(); }
  Mounting mounting() const override;

 private:
  KeyframeOdometry(const CameraSetup& setup, const OdometryOptions& options, PairwiseOdometry pairwise);

  // Bridging (keyframe_start.cpp).
  const FrameResult& bridge(const TrackedFrame& present);
  void adopt_bridge_scale();
  void close_bridge();
  bool is_guessed_after(int index) const;
  bool start_map(const TrackedFrame& present);
  int hang_bridge_on(int first, std::size_t bridged);
  void begin_trail();
  void lose_map(const TrackedFrame& present);
  std::optional<RigidTransform> find_again(TrackedFrame& present, FrameResult& result);
  void close_gap(const TrackedFrame& present, const RigidTransform& cam_from_world);

  // Mapping, in the order of a frame.
  const FrameResult& map_frame(FrameResult result, TrackedFrame& present);
  const FrameResult& stand(FrameResult result, const TrackedFrame& present);
  std::optional<RigidTransform> locate(const TrackedPoints& tracked, double time_s, FrameResult& result);
  bool stands_still(const TrackedPoints& tracked) const;
  bool wants_keyframe(const TrackedPoints& tracked) const;
  void add_keyframe(const TrackedFrame& present, const RigidTransform& cam_from_world);
  void use_camera(const CameraPtr& camera);
  void correct_map(int frame);
  void measure_scale(FrameResult& result, const TrackedFrame& present);
  std::optional<LoggedStep> logged_step() const;
  void hold_by_ground(const ScaleReport& report);
  void take_report(FrameResult& result, const ScaleReport& report);
  void refine_camera(const FrameResult& result);
  const FrameResult& append(FrameResult result, const RigidTransform& world_from_cam_m);
  void place(std::size_t k, const RigidTransform& world_from_cam_m);
  const FrameResult& coast(FrameResult result, const TrackedFrame& present, std::string reason);

  CameraPtr start_camera_;
  /// The present one, in the axes of the start's: poses, points and normals are all in these, and are turned where they
  /// come out.
  CameraPtr camera_;
  Eigen::Matrix3d camera_from_axes_ = Eigen::Matrix3d::Identity();
  OdometryOptions options_;
  Image tracking_mask_;
  Rng rng_;
  Tracker tracker_;
  RoadFollower road_;
  std::shared_ptr<SpeedReference> speed_;
  Bridge bridge_;

  LocalMap map_;
  LostMap lost_;
  ScaleKeeper keeper_;
  CameraRefiner refiner_;
  std::deque<TrackedFrame> recent_;
  MapTrail trail_;
  std::optional<double> pending_correction_;
  std::vector<ScaleEvent> corrections_;
  double last_drift_ratio_ = 1.0;
  bool correction_open_ = false;         ///< The last one waits for its first measurement.
  std::vector<TrackPoint> halt_points_;  ///< Of the last frame that moved.
  bool mapping_ = false;
  int located_ = 0;                 ///< Result of the last frame that the map has located.
  std::vector<TrackId> landmarks_;  ///< That the present frame was placed by,
  std::vector<int> agreeing_;       ///< those of them that agree.

  std::vector<FrameResult> results_;
  PoseLinks links_;
  std::vector<RigidTransform> online_poses_;                 ///< In the start camera's axes;
  std::vector<RigidTransform> online_output_, final_poses_;  ///< in the axes of the camera as known then.
  StageClock clock_;
  bool scaled_ = false;
};

}  // namespace groundscale
