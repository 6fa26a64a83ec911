#pragma once

#include <string>

#include "groundscale/core/options.hpp"
#include "groundscale/mapping/local_map.hpp"
#include "groundscale/mapping/resection.hpp"
#include "groundscale/mapping/road_tracks.hpp"
#include "groundscale/motion/two_view.hpp"
#include "groundscale/odometry/camera_refiner.hpp"
#include "groundscale/plane/methods.hpp"
#include "groundscale/road/region.hpp"
#include "groundscale/road/road_network.hpp"
#include "groundscale/road/road_tracker.hpp"
#include "groundscale/scale/gates.hpp"
#include "groundscale/scale/ground_filter.hpp"
#include "groundscale/scale/scale_keeper.hpp"
#include "groundscale/tracking/tracker.hpp"

namespace groundscale {

/// Which earlier frame a frame is paired with.
struct PairOptions {
  double min_parallax_px = 6.0;  ///< Upper quartile of the parallax that the pair should have.
  int max_frames = 30;           ///< How far back a partner may lie.
  int min_matches = 80;          ///< Fewer common tracks end the search.
};

void visit_fields(PairOptions& options, FieldVisitor& visitor);

struct GroundOptions {
  std::string method = "sparse";  ///< A name of `ground_methods`.
  PlaneOptions plane;
  GateOptions gates;
  GroundFilterOptions filter;
  bool follow_rotation = true;  ///< Carry the plane's pitch and roll from frame to frame by the camera's own rotation.
  bool use_structure = true;    ///< Predict the speed from tracked points seen in both pairs.
  int reopen_after = 5;         ///< Refusals in a row after which the filter trusts itself less.
  int search_after = 3;         ///< Refusals in a row after which the step is searched for anew.
  /// Sd of log step over the path's curvature, besides the filter's own: in a turn the road that is in view isn't the
  /// one that is driven on, and neighbouring frames share that error, so that no filter averages it out.
  double turn_sd_m = 0.3;
  /// The same for the path's curvature upwards or downwards. A plane through road that lies 4 to 22 m ahead misses the
  /// height of a parabola beneath the camera by curvature * near * far / 2: over 1.65 m that is 27 m times the
  /// curvature.
  double crest_sd_m = 27.0;
  double unsettled_prior_factor = 3.0;  ///< Until then the normal's prior is that much wider.
  int settle_after = 15;                ///< Accepted measurements that find the mounting.
};

void visit_fields(GroundOptions& options, FieldVisitor& visitor);

struct RoadOptions {
  RegionOptions region;
  RoadTrackingOptions tracking;
  WarpSearchOptions search;
  RoadNetworkOptions network;
};

void visit_fields(RoadOptions& options, FieldVisitor& visitor);

/// The two pipelines.
enum class OdometryMode { kPairwise, kKeyframe };
template <>
std::vector<std::string_view> names_of<OdometryMode>();

struct PipelineOptions {
  OdometryMode mode = OdometryMode::kKeyframe;
  ScaleCorrection scale_correction = ScaleCorrection::kFiltered;  ///< Of the keyframe odometry.
};

void visit_fields(PipelineOptions& options, FieldVisitor& visitor);

/// The keyframe odometry's own.
struct KeyframeOptions {
  double min_parallax_px = 10.0;    ///< To the last keyframe (upper quartile) that makes a new one,
  double min_share = 0.6;           ///< as does a smaller share of its points that are still followed.
  double start_parallax_px = 15.0;  ///< Of the two views that a map starts from,
  int start_matches = 100;          ///< with so many points in common
  int start_points = 60;            ///< and so many landmarks.
  StripOptions region{.far_m = 15.0, .half_width_m = 1.5};
  double ground_weight = 0.1;  ///< Of the ground in the bundle adjustment, over what its sd says (continuous).
  LocalMapOptions map;
  ResectionOptions resection;
  RoadTracksOptions road;
};

void visit_fields(KeyframeOptions& options, FieldVisitor& visitor);

/// Everything about `groundscale run` that a configuration file may say.
struct OdometryOptions {
  int seed = 0;
  PipelineOptions odometry;
  CameraRefineOptions camera;
  TrackingOptions tracking;
  MotionOptions motion;
  PairOptions pair;
  RoadOptions road;
  GroundOptions ground;
  KeyframeOptions keyframe;
  ScaleKeeperOptions scale;

  /// Ranges of all fields, a known method, near before far.
  Result<void> validate() const;
};

void visit_fields(OdometryOptions& options, FieldVisitor& visitor);

}  // namespace groundscale
