#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "groundscale/camera/mounting.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/motion/two_view.hpp"
#include "groundscale/odometry/frame_result.hpp"
#include "groundscale/odometry/mounting_estimate.hpp"
#include "groundscale/odometry/options.hpp"
#include "groundscale/odometry/structure.hpp"
#include "groundscale/odometry/views.hpp"
#include "groundscale/plane/methods.hpp"
#include "groundscale/road/road_tracker.hpp"
#include "groundscale/scale/gates.hpp"
#include "groundscale/scale/ground_filter.hpp"
#include "groundscale/scale/speed_reference.hpp"

namespace groundscale {

/// What was measured of the road in a pair, before anything judges it.
struct RoadMeasurement {
  PlaneMeasurement plane;                    ///< In the earlier camera, in baselines.
  std::vector<Eigen::Vector3d> inlier_rays;  ///< In that camera.
  double curvature_per_m = 0.0;              ///< Of the driven path.
};

/// A drive as a chain of pairs of views: the pose of each frame hangs on an earlier one, and the length of its step
/// comes from one way to measure the road, by gates and filter. Knows nothing of images. Whoever compares ways to
/// measure keeps a chain for each, with the same motions.
///
/// Deterministic. Memory grows by about 1 kB a frame.
class PairChain {
 public:
  /// Measures the road of a moving pair.
  /// @param expected_distance_m  Its baseline, as far as known.
  /// @param result               Its road figures may be filled in.
  /// @return the measurement, or why there is none.
  using MeasureRoad = std::function<Result<RoadMeasurement>(double expected_distance_m, FrameResult& result)>;

  /// @param setup  Its height_m must be set.
  PairChain(const CameraSetup& setup, const GroundOptions& options);
  /// A speed log that stands in where no road is measured.
  void use_speed(std::shared_ptr<SpeedReference> speed) { speed_ = std::move(speed); }
  const std::shared_ptr<SpeedReference>& speed() const { return speed_; }

  /// The next frame, by what it did. Of `result` its number, time and figures of matching are taken over.
  const FrameResult& begin(FrameResult result);
  const FrameResult& stand(FrameResult result);
  const FrameResult& rotate(FrameResult result, const PairMotion& pair);
  /// No motion was found: constant velocity.
  const FrameResult& bridge(FrameResult result, std::string reason);
  const FrameResult& move(FrameResult result, const PairMotion& pair, const MeasureRoad& measure);
  /// After the last frame: steps from the whole drive.
  void finish();

  const std::vector<FrameResult>& results() const { return results_; }
  const std::vector<RigidTransform>& online_poses() const { return online_poses_; }
  std::vector<RigidTransform> final_poses() const;
  bool scaled() const { return scaled_; }
  int bridged_in_a_row() const { return bridged_in_a_row_; }
  const MountingEstimate& mounting() const { return mounting_; }

  /// Whether what is expected of the next pair's distance isn't worth much.
  bool needs_search() const;
  /// How the road is expected to move between the views of a pair, in metres.
  RoadWarp expected_warp(const RigidTransform& cam2_from_cam1, double expected_distance_m) const;
  /// The same from an earlier frame to the latest; nothing where it isn't known in metres.
  std::optional<RoadWarp> latest_warp(int from_result) const;

 private:
  const FrameResult& append(FrameResult result, double step);
  double step_from_structure(const PairMotion& pair, GroundStep& step) const;
  std::string judge(const PairMotion& pair, const RoadMeasurement& measured, const GroundObservation& observation,
                    double expected_distance_m, double step_time_s) const;
  GroundObservation observe(const RoadMeasurement& measured, const PairMotion& pair, FrameResult& result) const;
  double take_measured(const PairMotion& pair, GroundObservation observation, double curvature_per_m,
                       double expected_step, FrameResult& result);
  double take_logged(const std::optional<LoggedStep>& logged, double dt_s, double expected_step, FrameResult& result);
  bool start_by_log(const LoggedStep& logged, double dt_s, double expected_step);
  void take_scale(double distance_m, double provisional_distance);
  GroundStep step_of(const PairMotion& pair, double dt_s) const;
  /// Distance from the partner to the frame before.
  double lead_of(const PairMotion& pair) const;
  /// Sd of log step that neighbouring frames share, so that filtering doesn't reduce it: from turns, crests and dips.
  double shape_sd() const;
  double time_since_last(const FrameResult& result) const;
  /// Sd of the log of a measured distance: the formal one, enlarged as the filter does.
  double enlarged_log_sd(const GroundObservation& observation) const;

  CameraPtr camera_;
  double camera_height_m_;
  GroundOptions options_;
  MountingEstimate mounting_;
  std::unique_ptr<GroundFilter> filter_;
  std::shared_ptr<SpeedReference> speed_;

  std::vector<FrameResult> results_;
  std::vector<RigidTransform> online_poses_;
  std::vector<StructurePoint> structure_;
  bool scaled_ = false;
  bool ground_seen_ = false;   ///< Whether a measurement of the ground has been accepted.
  double logged_m_ = 0.0;      ///< Way before the scale is known, by the speed log,
  double logged_units_ = 0.0;  ///< and the same in provisional units.
  int refused_in_a_row_ = 0;
  int bridged_in_a_row_ = 0;
};

}  // namespace groundscale
