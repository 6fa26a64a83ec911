#pragma once

#include <vector>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/geometry/ground_plane.hpp"
#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/tracking/detect.hpp"
#include "groundscale/tracking/front_end.hpp"
#include "groundscale/tracking/klt.hpp"
#include "groundscale/tracking/matches.hpp"

namespace groundscale {

struct RoadTrackingOptions {
  FrontEndKind front_end = FrontEndKind::kKlt;
  int max_points = 400;
  int rough_points = 250;  ///< Followed through the predicted warp, to find a better one.
  int fine_levels = 1;     ///< Reductions of the image through the better warp.
  DetectOptions detect{.cell_px = 8, .min_gradient = 0.5, .reduction = 1, .border_px = 8};
  KltOptions klt{.window_px = 16, .levels = 2, .max_iterations = 15, .min_step_px = 0.01, .max_round_trip_px = 0.3};
  /// Through the warp little is left to find, and neighbours move alike.
  StereoScanOptions stereoscan{
      .min_response = 20, .nms_px = 3, .coarse_nms_px = 7, .search_px = 16, .max_flow_change_px = 2.0, .reach_px = 3.0};
};

void visit_fields(RoadTrackingOptions& options, FieldVisitor& visitor);

/// What the road's image is expected to do between two views: handed in from outside, so that whoever knows motion and
/// plane (the pairwise filter, a map) can say it. Translation and plane in one unit, whichever.
struct RoadWarp {
  RigidTransform cam2_from_cam1;
  GroundPlane road_in_cam1;
};

/// Follows road points from one image to another after the second has been warped as the road is expected to move, so
/// that patches that stretch as they come near don't bias the tracker. Pixels go through the camera model:
/// x2 = project(H ray(x1)).
/// @return A match for each point that came back to its start, under the point's id.
Matches track_on_road(const Image& first, const Image& second, const std::vector<TrackPoint>& points,
                      const RoadWarp& warp, const Camera& camera, const KltOptions& options);

struct WarpSearch {
  RoadWarp warp;             ///< cam2_from_cam1 in metres, road at the camera's height.
  double correlation = 0.0;  ///< -1 to 1; -1 where nothing could be compared.
};

struct WarpSearchOptions {
  double min_step_m = 0.15;
  double max_step_m = 3.2;
  double max_pitch_change_deg = 2.0;
};

void visit_fields(WarpSearchOptions& options, FieldVisitor& visitor);

/// The step and pitch with which the warped region of the second image correlates best with the first one (zero-mean
/// normalised correlation).
/// @param mask  The region in the first image.
/// @param guess  Road in metres; of the motion rotation and direction are used, its length is what is looked for.
WarpSearch search_warp(const Image& first, const Image& second, const Image& mask, const RoadWarp& guess,
                       const Camera& camera, const WarpSearchOptions& options);

}  // namespace groundscale
