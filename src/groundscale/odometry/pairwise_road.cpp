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
  if (options.polygon_px.empty()) {
    observations.weight_of_ray = [path, metric_road, sd_m = options.weight_sd_m](const Eigen::Vector3d& ray) {
      const double offset = offset_from_path(path, metric_road, ray) / sd_m;
      constexpr double kMinWeight = 1e-3;
      return std::max(kMinWeight, std::exp(-0.5 * offset * offset));
    };
  }
  for (const Match& match : matches) {
    RoadPoint point{match.id, match.pixel1, {RoadSight{1, match.pixel2}}};
    const auto ray = camera->ray(match.pixel1);
    if (ray && observations.weight_of_ray) point.weight = observations.weight_of_ray(*ray);
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

bool PairwiseOdometry::needs_search() const {
  const bool after_loss = !results_.empty() && results_.back().state == FrameState::kLost;
  return !scaled_ || after_loss || (refused_in_a_row_ > 0 && refused_in_a_row_ % options_.ground.search_after == 0);
}

RoadWarp PairwiseOdometry::expected_warp(const Pair& pair, double expected_distance_m) const {
  RoadWarp warp;
  warp.cam2_from_cam1 = {pair.motion.cam2_from_cam1.rotation,
                         expected_distance_m * pair.motion.cam2_from_cam1.translation};
  warp.road_in_cam1 = {mounting_.mean_normal(), camera_height_m_};
  if (filter_->started()) {
    const GroundState state = filter_->state();
    const Eigen::Vector3d normal = state.normal_in_cam();
    warp.road_in_cam1.normal_in_cam =
        options_.ground.follow_rotation ? Eigen::Vector3d(warp.cam2_from_cam1.rotation.transpose() * normal) : normal;
  }
  return warp;
}

DrivenPath PairwiseOdometry::path_of(const RoadWarp& warp) const {
  DrivenPath path =
      path_of_motion(warp.cam2_from_cam1, warp.road_in_cam1.normal_in_cam, mounting_.mounting().forward_in_cam());
  path.max_turn_rad = options_.road.region.max_turn_deg * std::numbers::pi / 180.0;
  return path;
}

Result<PlaneMeasurement> PairwiseOdometry::measure_plane(const EstimatePlane& method, const Pair& pair,
                                                         const RoadWarp& warp, const Image& image) {
  clock_.lap("road tracking");
  RoadObservations observations =
      observations_of(road_matches_, camera_, pair.motion, path_of(warp), warp.road_in_cam1, options_.road.region);
  observations.expected_normal = mounting_.mean_normal();
  if (!mounting_.settled()) observations.normal_prior_factor = options_.ground.unsettled_prior_factor;
  observations.predicted_plane = {warp.road_in_cam1.normal_in_cam,
                                  warp.road_in_cam1.height / warp.cam2_from_cam1.translation.norm()};
  observations.scene = scene_of(pair);
  observations.images = {pair.partner->road.image, image};
  observations.region = details_.region;
  auto plane = method(observations, rng_);
  clock_.lap("plane");
  return plane;
}

std::optional<PairwiseOdometry::Measured> PairwiseOdometry::measure_road(const Pair& pair, double expected_distance_m,
                                                                         FrameResult& result, const Frame& frame) {
  RoadWarp warp = expected_warp(pair, expected_distance_m);
  const auto region_of = [&](const RoadWarp& expected) {
    const Image strip = region_mask(path_of(expected), expected.road_in_cam1, *camera_, options_.road.region);
    return restrict_region(restrict_region(strip, tracking_mask_), pair.partner->road_mask);
  };
  Image region = region_of(warp);
  if (needs_search()) {
    const WarpSearch found =
        search_warp(pair.partner->road.image, frame.image, region, warp, *camera_, options_.road.search);
    constexpr double kMinCorrelation = 0.3;
    if (found.correlation > kMinCorrelation) {
      warp = found.warp;
      region = region_of(warp);
    }
  }
  clock_.lap("region");
  road_matcher_.fill(pair.partner->road, region);
  clock_.lap("road detection");
  details_.region = region;
  details_.reference_image = pair.partner->road.image;

  // Warp, track, refine the plane, and the same again with the better warp (bias and spread halve).
  const RoadView& partner = pair.partner->road;
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
  if (!plane) {
    result.reason = plane.error().message;
    return std::nullopt;
  }
  result.road_inliers = static_cast<int>(plane->inliers.size());
  result.road_rms_px = plane->rms_px;
  details_.road_inliers = plane->inliers;

  const PlaneAngles in_partner = plane_angles(plane->plane.normal_in_cam);
  result.pitch_rad = in_partner.pitch_rad;
  result.roll_rad = in_partner.roll_rad;
  Measured measured;
  measured.observation = observation_of(plane->plane, plane->covariance_of_m, camera_height_m_);
  measured.refusal = judge(pair, *plane, measured.observation, expected_distance_m, time_since_last(frame));
  if (options_.ground.follow_rotation) {
    const PlaneAngles now = plane_angles(pair.motion.cam2_from_cam1.rotation * plane->plane.normal_in_cam);
    measured.observation.pitch_rad = now.pitch_rad;
    measured.observation.roll_rad = now.roll_rad;
  }
  return measured;
}

std::string PairwiseOdometry::judge(const Pair& pair, const PlaneMeasurement& plane,
                                    const GroundObservation& observation, double expected_distance_m,
                                    double step_time_s) const {
  GateContext context;
  context.mounting_normal = mounting_.mounting().normal_in_cam();
  context.mounting_settled = mounting_.settled();
  context.mean_normal = mounting_.mean_normal();
  context.filter_started = filter_->started() && ground_seen_;
  context.expected_distance_m = expected_distance_m;
  context.expected_log_sd = filter_->started() ? filter_->state().log_speed_sd : 0.0;
  context.step_time_s = step_time_s;
  context.pair_time_s = step_time_s + results_.back().time_s - pair.partner->time_s;
  GateCandidate candidate;
  candidate.initial_plane = plane.initial_plane;
  candidate.plane = plane.plane;
  for (const int i : plane.inliers) {
    const auto ray = camera_->ray(road_matches_[static_cast<std::size_t>(i)].pixel1);
    if (ray) candidate.inlier_rays.push_back(*ray);
  }
  candidate.distance_m = std::exp(observation.log_distance);
  candidate.log_sd = enlarged_log_sd(observation);
  return refusal(candidate, context, options_.ground.gates);
}

double PairwiseOdometry::enlarged_log_sd(const GroundObservation& observation) const {
  return std::sqrt(options_.ground.filter.formal_variance_factor * observation.covariance(2, 2));
}

}  // namespace groundscale
