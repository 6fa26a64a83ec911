// The road's part of the pairwise odometry: what is expected, where it is looked for, what is measured and accepted.
#include <utility>

#include "groundscale/odometry/pair_observations.hpp"
#include "groundscale/odometry/pairwise.hpp"

namespace groundscale {
RoadMeasurement road_measurement(PlaneMeasurement plane, const RoadSights& sights) {
  RoadMeasurement measured;
  measured.curvature_per_m = sights.curvature_per_m;
  for (const int i : plane.inliers) {
    const RoadPoint& point = sights.observations.points[static_cast<std::size_t>(i)];
    const auto ray = sights.observations.camera->ray(point.pixel_in_reference);
    if (ray) measured.inlier_rays.push_back(*ray);
  }
  measured.plane = std::move(plane);
  return measured;
}

DrivenPath PairwiseOdometry::path_of(const RoadWarp& warp) const {
  return path_of_motion(warp.cam2_from_cam1, warp.road_in_cam1.normal_in_cam, mounting().forward_in_cam(),
                        options_.road.region.max_turn_deg);
}

/// What the present road matches say of the plane.
Result<PlaneMeasurement> PairwiseOdometry::measure_plane(const EstimatePlane& method, const Pair& pair,
                                                         const RoadWarp& warp, const Image& image) {
  clock_.lap("road tracking");
  const DrivenPath path = path_of(warp);
  RoadObservations observations = observe_pair(pair, road_matches_, camera_, {warp, path}, options_.road.region);
  const MountingEstimate& mounting = chain_.mounting();
  observations.expected_normal = mounting.mean_normal();
  observations.predicted_plane = predicted_plane_;
  if (!mounting.settled()) observations.normal_prior_factor = options_.ground.unsettled_prior_factor;
  observations.images = {pair.view->road.image, image};
  observations.region = details_.region;
  road_ = {std::move(observations), path.curvature_per_m};
  auto plane = method(road_->observations, rng_);
  clock_.lap("plane");
  return plane;
}

Result<RoadMeasurement> PairwiseOdometry::measure_road(const Pair& pair, double expected_distance_m,
                                                       FrameResult& result, const Frame& frame) {
  RoadWarp warp = chain_.expected_warp(pair.motion.cam2_from_cam1, expected_distance_m);
  RoadView& partner = pair.view->road;
  const auto region_of = [&](const RoadWarp& expected) {
    const Image strip = region_mask(path_of(expected), expected.road_in_cam1, *camera_, options_.road.region);
    return restrict_region(restrict_region(strip, tracking_mask_), pair.view->road_mask);
  };
  Image region = region_of(warp);
  predicted_plane_.reset();
  if (chain_.scaled()) predicted_plane_ = plane_in_baselines(warp);
  if (chain_.needs_search()) {
    const WarpSearch found = search_warp(partner.image, frame.image, region, warp, *camera_, options_.road.search);
    constexpr double kMinCorrelation = 0.3;
    if (found.correlation > kMinCorrelation) {
      warp = found.warp;
      predicted_plane_ = plane_in_baselines(warp);
      region = region_of(warp);
    }
  }
  clock_.lap("region");
  road_matcher_.fill(partner, region);
  clock_.lap("road detection");
  details_.region = region;
  details_.reference_image = partner.image;

  // Warp, track, refine the plane, and the same again with the better warp (bias and spread halve).
  road_matches_ = road_matcher_.match_roughly(partner, frame.image, warp, *camera_);
  Result<PlaneMeasurement> plane = measure_plane(refine_warp_, pair, warp, frame.image);
  if (plane) {
    warp = warp_in_metres(plane->plane, pair.motion.cam2_from_cam1, camera_height_m_);
  }
  road_matches_ = road_matcher_.match(partner, frame.image, warp, plane.has_value(), *camera_);
  plane = measure_plane(estimate_plane_, pair, warp, frame.image);
  result.road_matches = static_cast<int>(road_matches_.size());
  details_.road_matches = road_matches_;
  details_.road = warp.road_in_cam1;
  details_.path = path_of(warp);
  details_.cam_from_reference = warp.cam2_from_cam1;
  if (!plane) return plane.error();
  result.road_inliers = static_cast<int>(plane->inliers.size());
  result.road_rms_px = plane->rms_px;
  details_.road_inliers = plane->inliers;
  return road_measurement(std::move(*plane), *road_);
}

}  // namespace groundscale
