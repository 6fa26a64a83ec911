// The road's part of the pairwise odometry: what is expected, where it is looked for, what is measured and accepted.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "groundscale/odometry/pairwise.hpp"

namespace groundscale {
namespace {

/// Road matches for the plane. Points beside the path count less; with a fixed region nothing is known of a path.
RoadObservations observations_of(const Matches& matches, const CameraPtr& camera, const TwoViewMotion& motion,
                                 const DrivenPath& path, const GroundPlane& metric_road, const RegionOptions& options) {
  RoadObservations observations;
  observations.camera = camera;
  observations.cam_from_reference = {RigidTransform{}, motion.cam2_from_cam1};
  observations.motion_covariance = motion.covariance;
  for (const Match& match : matches) {
    RoadPoint point{match.id, match.pixel1, {RoadSight{1, match.pixel2}}};
    const auto ray = camera->ray(match.pixel1);
    if (ray && options.polygon_px.empty()) {
      const double offset = offset_from_path(path, metric_road, *ray) / options.weight_sd_m;
      constexpr double kMinWeight = 1e-3;
      point.weight = std::max(kMinWeight, std::exp(-0.5 * offset * offset));
    }
    observations.points.push_back(std::move(point));
  }
  return observations;
}

/// Points of the pair over the whole image that agree with its motion.
std::vector<ScenePoint> scene_of(const Pair& pair) {
  std::vector<ScenePoint> scene;
  scene.reserve(pair.motion.inliers.size());
  auto match = pair.matches.begin();
  for (const int i : pair.motion.inliers) {
    const TrackId id = pair.rays[static_cast<std::size_t>(i)].id;
    match = std::find_if(match, pair.matches.end(), [id](const Match& other) { return other.id == id; });
    scene.push_back({match->pixel1, match->pixel2});
  }
  return scene;
}

}  // namespace

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
  DrivenPath path = path_of_motion(warp.cam2_from_cam1, warp.road_in_cam1.normal_in_cam, mounting().forward_in_cam());
  path.max_turn_rad = options_.road.region.max_turn_deg * std::numbers::pi / 180.0;
  return path;
}

/// What the present road matches say of the plane.
Result<PlaneMeasurement> PairwiseOdometry::measure_plane(const EstimatePlane& method, const Pair& pair,
                                                         const RoadWarp& warp, const Image& image) {
  clock_.lap("road tracking");
  const DrivenPath path = path_of(warp);
  RoadObservations observations =
      observations_of(road_matches_, camera_, pair.motion, path, warp.road_in_cam1, options_.road.region);
  const MountingEstimate& mounting = chain_.mounting();
  observations.expected_normal = mounting.mean_normal();
  if (!mounting.settled()) observations.normal_prior_factor = options_.ground.unsettled_prior_factor;
  observations.predicted_plane = {warp.road_in_cam1.normal_in_cam,
                                  warp.road_in_cam1.height / warp.cam2_from_cam1.translation.norm()};
  observations.scene = scene_of(pair);
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
  if (chain_.needs_search()) {
    const WarpSearch found = search_warp(partner.image, frame.image, region, warp, *camera_, options_.road.search);
    constexpr double kMinCorrelation = 0.3;
    if (found.correlation > kMinCorrelation) {
      warp = found.warp;
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
    const double distance_m = camera_height_m_ / plane->plane.height;
    warp.cam2_from_cam1.translation = distance_m * pair.motion.cam2_from_cam1.translation;
    warp.road_in_cam1 = {plane->plane.normal_in_cam, camera_height_m_};
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
