#include "groundscale/odometry/pair_observations.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace groundscale {
namespace {

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

GroundPlane plane_in_baselines(const RoadWarp& expected) {
  return {expected.road_in_cam1.normal_in_cam,
          expected.road_in_cam1.height / expected.cam2_from_cam1.translation.norm()};
}

RoadWarp warp_in_metres(const GroundPlane& in_baselines, const RigidTransform& cam2_from_cam1, double camera_height_m) {
  const double distance_m = camera_height_m / in_baselines.height;
  return {{cam2_from_cam1.rotation, distance_m * cam2_from_cam1.translation},
          {in_baselines.normal_in_cam, camera_height_m}};
}

RoadObservations observe_pair(const Pair& pair, const Matches& road_matches, const CameraPtr& camera,
                              const ExpectedRoad& expected, const RegionOptions& region) {
  const GroundPlane& road = expected.warp.road_in_cam1;
  RoadObservations observations;
  observations.camera = camera;
  observations.cam_from_reference = {RigidTransform{}, pair.motion.cam2_from_cam1};
  observations.motion_covariance = pair.motion.covariance;
  const RigidTransform& motion = pair.motion.cam2_from_cam1;
  observations.driving_direction = -(motion.rotation.transpose() * motion.translation).normalized();
  if (region.polygon_px.empty()) {
    observations.weight_of_ray = [path = expected.path, road, sd_m = region.weight_sd_m](const Eigen::Vector3d& ray) {
      const double offset = offset_from_path(path, road, ray) / sd_m;
      constexpr double kMinWeight = 1e-3;
      return std::max(kMinWeight, std::exp(-0.5 * offset * offset));
    };
  }
  for (const Match& match : road_matches) {
    RoadPoint point{match.id, match.pixel1, {RoadSight{1, match.pixel2}}};
    const auto ray = camera->ray(match.pixel1);
    if (ray && observations.weight_of_ray) point.weight = observations.weight_of_ray(*ray);
    observations.points.push_back(std::move(point));
  }
  observations.scene = scene_of(pair);
  return observations;
}

}  // namespace groundscale
