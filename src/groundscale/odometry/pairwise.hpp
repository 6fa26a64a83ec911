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
#include "groundscale/odometry/pair_chain.hpp"
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

/// What the road of a pair is measured from, by whichever method.
struct RoadSights {
  RoadObservations observations;
  double curvature_per_m = 0.0;  ///< Of the driven path.
};

/// A method's measurement with what a chain needs to judge it.
RoadMeasurement road_measurement(PlaneMeasurement plane, const RoadSights& sights);

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

  void finish() override { chain_.finish(); }

  const std::vector<FrameResult>& results() const override { return chain_.results(); }
  FrameDetails details() const override { return details_; }
  bool scaled() const override { return chain_.scaled(); }
  const std::vector<RigidTransform>& online_poses() const override { return chain_.online_poses(); }
  std::vector<RigidTransform> final_poses() const override { return chain_.final_poses(); }
  const std::vector<TrackPoint>& tracks() const override { return tracker_.points(); }
  const StageClock& clock() const override { return clock_; }
  Mounting mounting() const override { return chain_.mounting().mounting(); }
  const RoadDetector* road_detector() const override { return detector_.get(); }
  /// The road network shared with another odometry, which gives it frames by turns.
  std::shared_ptr<RoadDetector> shared_detector() const { return detector_; }
  void share_detector(std::shared_ptr<RoadDetector> detector) { detector_ = std::move(detector); }
  const SpeedReference* speed_reference() const override { return chain_.speed().get(); }
  /// The speed log shared likewise, with what is known of how it agrees with the ground.
  std::shared_ptr<SpeedReference> shared_speed() const { return chain_.speed(); }
  void share_speed(std::shared_ptr<SpeedReference> speed) { chain_.use_speed(std::move(speed)); }
  /// The pair of the latest frame; none where it stood or no motion was found.
  const PairMotion& latest_pair() const { return pair_; }
  /// What its road was measured from; empty unless it moved.
  const std::optional<RoadSights>& latest_road() const { return road_; }
  const MountingEstimate& mounting_estimate() const { return chain_.mounting(); }

 private:
  PairwiseOdometry(const CameraSetup& setup, const OdometryOptions& options);

  const FrameResult& move(FrameResult result, const Pair& pair, const Frame& frame);
  Result<RoadMeasurement> measure_road(const Pair& pair, double expected_distance_m, FrameResult& result,
                                       const Frame& frame);
  Result<PlaneMeasurement> measure_plane(const EstimatePlane& method, const Pair& pair, const RoadWarp& warp,
                                         const Image& image);
  DrivenPath path_of(const RoadWarp& warp) const;
  void remember_view(const Frame& frame);

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
  PairChain chain_;
  Views views_;

  PairMotion pair_;                             ///< Of the present frame,
  std::optional<RoadSights> road_;              ///< with its road,
  std::optional<GroundPlane> predicted_plane_;  ///< and where that was looked for.
  std::optional<RigidTransform> last_motion_;   ///< Unit translation, of the last moving pair.
  Matches road_matches_;                        ///< Of the present frame, after the last pass.
  Image road_mask_;                             ///< Of the present frame.
  FrameDetails details_;
  StageClock clock_;
};

}  // namespace groundscale
