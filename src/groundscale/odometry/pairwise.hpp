#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "groundscale/camera/camera.hpp"
#include "groundscale/camera/mounting.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/core/stage_clock.hpp"
#include "groundscale/geometry/trajectory.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/sequence.hpp"
#include "groundscale/odometry/frame_result.hpp"
#include "groundscale/odometry/mounting_estimate.hpp"
#include "groundscale/odometry/odometry.hpp"
#include "groundscale/odometry/options.hpp"
#include "groundscale/odometry/structure.hpp"
#include "groundscale/odometry/views.hpp"
#include "groundscale/road/road_detector.hpp"
#include "groundscale/road/road_matcher.hpp"
#include "groundscale/tracking/tracker.hpp"

namespace groundscale {

/// Where the tracker may work: all but the own vehicle.
Image allowed_of(const Image& vehicle_mask);

/// Points of a frame that have lasting ids.
struct TrackedPoints {
  std::vector<TrackPoint> points;  ///< Ids ascending.
  int followed = 0;                ///< How many of them were there in the frame before.
};

/// Frame-to-frame odometry whose scale comes from the road: Algorithm 1 of Zhou, Dai, Li 2019 for each frame and an
/// earlier one with enough parallax. Images in, metric poses out.
///
/// Deterministic for given images, camera and options. Memory grows by about 1 kB a frame.
class PairwiseOdometry final : public Odometry {
 public:
  /// @param setup  Its height_m must be set. Pitch and roll that it leaves out are found in the first seconds.
  /// @return kBadInput where no road is in view with the camera so mounted, options are out of range, or the
  ///         road network or the speed log can't be used.
  static Result<PairwiseOdometry> create(const CameraSetup& setup, const OdometryOptions& options);

  /// @param road_mask  It counts where the frame is the earlier one of a pair, in whose image the road region lies.
  /// With a
  ///                   road network of its own both must see road.
  const FrameResult& advance(const Frame& frame, const Image& road_mask) override;
  using Odometry::advance;
  /// The same for a frame whose points somebody else has followed.
  const FrameResult& advance(const Frame& frame, const Image& road_mask, const TrackedPoints& tracked);

  void finish() override;

  const std::vector<FrameResult>& results() const override { return results_; }
  FrameDetails details() const override { return details_; }
  bool scaled() const override { return scaled_; }
  const std::vector<RigidTransform>& online_poses() const override { return online_poses_; }
  std::vector<RigidTransform> final_poses() const override;
  const std::vector<TrackPoint>& tracks() const override { return tracker_.points(); }
  const StageClock& clock() const override { return clock_; }
  Mounting mounting() const override { return mounting_.mounting(); }
  const RoadDetector* road_detector() const override { return detector_.get(); }
  /// The road network shared with another odometry, which gives it frames by turns.
  std::shared_ptr<RoadDetector> shared_detector() const { return detector_; }
  void share_detector(std::shared_ptr<RoadDetector> detector) { detector_ = std::move(detector); }
  const SpeedReference* speed_reference() const override { return speed_.get(); }
  /// The speed log shared likewise, with what is known of how it agrees with the ground.
  std::shared_ptr<SpeedReference> shared_speed() const { return speed_; }
  void share_speed(std::shared_ptr<SpeedReference> speed) { speed_ = std::move(speed); }
  const MountingEstimate& mounting_estimate() const { return mounting_; }

 private:
  PairwiseOdometry(const CameraSetup& setup, const OdometryOptions& options);

  struct Measured {
    GroundObservation observation;
    std::string refusal;
  };

  const FrameResult& append(FrameResult result, double step);
  const FrameResult& bridge(FrameResult result, std::string reason, const Frame& frame);
  const FrameResult& stand(FrameResult result, const Frame& frame);
  const FrameResult& rotate(FrameResult result, const Pair& pair, const Frame& frame);
  const FrameResult& move(FrameResult result, Pair pair, const Frame& frame);

  double step_from_structure(const Pair& pair, GroundStep& step) const;
  std::optional<Measured> measure_road(const Pair& pair, double expected_distance_m, FrameResult& result,
                                       const Frame& frame);
  Result<PlaneMeasurement> measure_plane(const EstimatePlane& method, const Pair& pair, const RoadWarp& warp,
                                         const Image& image);
  DrivenPath path_of(const RoadWarp& warp) const;
  RoadWarp expected_warp(const Pair& pair, double expected_distance_m) const;
  bool needs_search() const;
  std::string judge(const Pair& pair, const PlaneMeasurement& plane, const GroundObservation& observation,
                    double expected_distance_m, double step_time_s) const;
  double take_measured(const Pair& pair, GroundObservation observation, double expected_step, FrameResult& result);
  double take_logged(const std::optional<LoggedStep>& logged, double dt_s, double expected_step, FrameResult& result);
  bool start_by_log(const LoggedStep& logged, double dt_s, double expected_step);
  void take_scale(double distance_m, double provisional_distance);
  GroundStep step_of(const Pair& pair, double dt_s) const;
  double lead_of(const Pair& pair) const;
  /// Sd of log step that neighbouring frames share, so that filtering doesn't reduce it: from turns, crests and dips.
  double shape_sd() const;
  double time_since_last(const Frame& frame) const;
  /// Sd of the log of a measured distance: the formal one, enlarged as the filter does.
  double enlarged_log_sd(const GroundObservation& observation) const;
  void remember_view(const Frame& frame, int result_index);
  /// Motion from the last remembered view to the present frame; nothing where there is none in metres.
  std::optional<RoadWarp> warp_from_latest_view() const;

  CameraPtr camera_;
  double camera_height_m_;
  Image tracking_mask_;
  OdometryOptions options_;
  EstimatePlane refine_warp_;     ///< Whatever the method: what it measures from mustn't depend on it.
  EstimatePlane estimate_plane_;  ///< The method that the options name.
  Rng rng_;
  Tracker tracker_;
  TrackedPoints tracked_;  ///< Of the present frame.
  RoadMatcher road_matcher_;
  std::shared_ptr<RoadDetector> detector_;
  std::shared_ptr<SpeedReference> speed_;
  MountingEstimate mounting_;
  std::unique_ptr<GroundFilter> filter_;
  Views views_;

  std::vector<FrameResult> results_;
  std::vector<RigidTransform> online_poses_;
  std::vector<StructurePoint> structure_;
  std::optional<RigidTransform> last_motion_;  ///< Unit translation, of the last moving pair.
  Matches road_matches_;                       ///< Of the present frame, after the last pass.
  Image road_mask_;                            ///< Of the present frame.
  FrameDetails details_;
  StageClock clock_;
  bool scaled_ = false;
  bool ground_seen_ = false;   ///< Whether a measurement of the ground has been accepted.
  double logged_m_ = 0.0;      ///< Way before the scale is known, by the speed log,
  double logged_units_ = 0.0;  ///< and the same in provisional units.
  int refused_in_a_row_ = 0;
  int bridged_in_a_row_ = 0;
};

}  // namespace groundscale
