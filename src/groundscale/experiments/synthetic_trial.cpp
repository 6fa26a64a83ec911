#include "groundscale/experiments/synthetic_trial.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "groundscale/core/check.hpp"

namespace groundscale {
namespace {

Eigen::Vector2d unit_noise(Rng& rng) {
  const double x = rng.normal();
  return {x, rng.normal()};
}

}  // namespace

SyntheticTrial::SyntheticTrial(const SyntheticWorld& world, const std::vector<Eigen::Vector2d>& features,
                               std::uint64_t seed)
    : world_(world) {
  Rng rng(seed);
  const GroundPlane& road = world.metric_road;
  for (const Eigen::Vector2d& feature : features) {
    const Eigen::Vector2d noise = unit_noise(rng);
    const auto ray = world.camera->ray(feature);
    if (!ray) continue;
    const double down = road.normal_in_cam.dot(*ray);
    if (down > 0.0) points_.push_back({feature, *ray * (road.height / down), noise, true});
  }
  for (int k = 0; k < world.scene_points; ++k) {
    const double u = rng.uniform(0.0, world.camera->width() - 1.0);
    const Eigen::Vector2d pixel(u, rng.uniform(0.0, world.camera->height() - 1.0));
    const double depth_m = std::exp(rng.uniform(std::log(world.nearest_m), std::log(world.farthest_m)));
    const Eigen::Vector2d noise = unit_noise(rng);
    const auto ray = world.camera->ray(pixel);
    if (!ray || !(ray->z() > 0.0)) continue;
    double length_m = depth_m / ray->z();
    const double down = road.normal_in_cam.dot(*ray);
    if (down * length_m > road.height) length_m = road.height / down;
    points_.push_back({pixel, *ray * length_m, noise, false});
  }
}

RoadObservations SyntheticTrial::observe(const RigidTransform& metric_cam2_from_cam1, double noise_px) const {
  const double step_m = metric_cam2_from_cam1.translation.norm();
  GS_CHECK(step_m > 0.0, "a pair of views has a baseline");
  RoadObservations observations;
  observations.camera = world_.camera;
  observations.cam_from_reference = {RigidTransform{},
                                     {metric_cam2_from_cam1.rotation, metric_cam2_from_cam1.translation / step_m}};
  observations.expected_normal = world_.metric_road.normal_in_cam;
  std::int64_t id = 0;
  for (const Point& point : points_) {
    const auto pixel2 = world_.camera->project(metric_cam2_from_cam1 * point.in_cam1_m);
    if (!pixel2 || !world_.camera->contains(*pixel2)) continue;
    const Eigen::Vector2d noisy = *pixel2 + noise_px * point.unit_noise;
    if (point.road) observations.points.push_back({id++, point.pixel1, {RoadSight{1, noisy}}});
    observations.scene.push_back({point.pixel1, noisy});
  }
  return observations;
}

std::optional<RoadObservations> with_estimated_motion(RoadObservations observations, const MotionOptions& options,
                                                      Rng& rng) {
  Matches matches;
  for (const ScenePoint& point : observations.scene) {
    matches.push_back({static_cast<TrackId>(matches.size()), point.pixel_in_reference, point.pixel_in_view1});
  }
  const std::vector<RayPair> rays = ray_pairs(matches, *observations.camera);
  const TwoViewMotion motion = estimate_motion(rays, observations.camera->focal_px(), options, rng);
  if (motion.state != MotionState::kMoving) return std::nullopt;
  std::vector<ScenePoint> agreeing;
  for (const int inlier : motion.inliers) {
    const TrackId id = rays[static_cast<std::size_t>(inlier)].id;
    agreeing.push_back(observations.scene[static_cast<std::size_t>(id)]);
  }
  observations.scene = std::move(agreeing);
  observations.cam_from_reference[1] = motion.cam2_from_cam1;
  observations.motion_covariance = motion.covariance;
  return observations;
}

}  // namespace groundscale
