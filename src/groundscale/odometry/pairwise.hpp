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
#include "groundscale/odometry/options.hpp"
#include "groundscale/odometry/structure.hpp"
#include "groundscale/odometry/views.hpp"
#include "groundscale/road/road_detector.hpp"
#include "groundscale/road/road_matcher.hpp"
#include "groundscale/tracking/tracker.hpp"

namespace groundscale {

/// What a frame was measured from, for pictures and figures. Valid until the next frame.
struct FrameDetails {
  Image reference_image;  ///< Of the partner, in which the region lies.
  Image region;
  std::vector<RayPair> pairs;  ///< Whole image.
  Matches matches;             ///< The same in pixels.
  std::vector<int> inliers;
  Matches road_matches;
  std::vector<int> road_inliers;
  GroundPlane road;  ///< Metres, in the partner's camera.
  DrivenPath path;
  RigidTransform cam_from_reference;  ///< Metres.
};

/// Frame-to-frame odometry whose scale comes from the road: Algorithm 1 of Zhou, Dai, Li 2019 for each frame and an
/// earlier one with enough parallax. Images in, metric poses out.
///
/// Deterministic for given images, camera and options. Memory grows by about 1 kB a frame.
class PairwiseOdometry {
 public:
  /// @param setup  Its height_m must be set. Pitch and roll that it leaves out are found in the first seconds.
  /// @return kBadInput where no road is in view with the camera so mounted, options are out of range, or the road
  /// network
  ///         can't be used.
  static Result<PairwiseOdometry> create(const CameraSetup& setup, const OdometryOptions& options);

  /// Takes the next frame.
  /// @param road_mask  Of this frame's size: 0 where a detector saw no road; empty: no detector. It counts where the
  ///                   frame is the earlier one of a pair, in whose image the road region lies. With a road network of
  ///                   its own both must see road.
  const FrameResult& advance(const Frame& frame, const Image& road_mask = {});

  /// After the last frame: steps from the whole drive.
  void finish();

  const std::vector<FrameResult>& results() const { return results_; }
  const FrameDetails& details() const { return details_; }
  /// Whether scale is known; before, online poses are in a provisional unit.
  bool scaled() const { return scaled_; }
  /// Poses from frames up to each one's own, in metres once `scaled`.
  const std::vector<RigidTransform>& online_poses() const { return online_poses_; }
  /// Poses from the whole drive, after `finish`.
  std::vector<RigidTransform> final_poses() const;
  /// Time that each stage has taken so far.
  const StageClock& clock() const { return clock_; }
  /// The road network, where the options name one.
  const std::optional<RoadDetector>& road_detector() const { return detector_; }
  /// Mounting as found so far.
  Mounting mounting() const { return mounting_.mounting(); }

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
  Result<PlaneMeasurement> measure_plane(const Pair& pair, const RoadWarp& warp);
  DrivenPath path_of(const RoadWarp& warp) const;
  RoadWarp expected_warp(const Pair& pair, double expected_distance_m) const;
  bool needs_search() const;
  std::string judge(const Pair& pair, const PlaneMeasurement& plane, const GroundObservation& observation,
                    double expected_distance_m, double step_time_s) const;
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
  EstimatePlane estimate_plane_;
  Rng rng_;
  Tracker tracker_;
  RoadMatcher road_matcher_;
  std::optional<RoadDetector> detector_;
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
  int refused_in_a_row_ = 0;
  int bridged_in_a_row_ = 0;
};

}  // namespace groundscale
