#include "groundscale/simulation/drive_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "groundscale/road/region.hpp"

namespace groundscale {
namespace {

/// A point of the road in the camera, and how much it counts.
struct RoadPoint {
  Eigen::Vector3d in_cam = Eigen::Vector3d::Zero();
  double weight = 1.0;
};

/// The road (no kerb, no pavement) in the default region, weighted as road points are.
std::vector<RoadPoint> road_ahead(const RoadSurface& surface, const CameraMoment& moment) {
  const RegionOptions region;
  constexpr double kAlongM = 0.5;
  constexpr double kAsideM = 0.25;
  const RigidTransform cam_from_world = moment.world_from_cam.inverse();
  std::vector<RoadPoint> points;
  for (double along = region.near_m; along <= region.far_m; along += kAlongM) {
    const PathPoint point = surface.path().at(moment.distance_m + along);
    for (double aside = -region.half_width_m; aside <= region.half_width_m; aside += kAsideM) {
      Eigen::Vector3d place = point.position + aside * point.right();
      const RoadPlace on_ground = surface.locate(place.x(), place.z());
      if (on_ground.ground != Ground::kRoad) continue;
      place.y() = on_ground.ground_y;
      points.push_back({cam_from_world * place, std::exp(-0.5 * std::pow(aside / region.weight_sd_m, 2))});
    }
  }
  return points;
}

bool inside(const std::vector<double>& polygon, double x, double y) {
  bool odd = false;
  const std::size_t count = polygon.size() / 2;
  for (std::size_t k = 0, before = count - 1; k < count; before = k++) {
    const double y1 = polygon[2 * before + 1];
    const double y2 = polygon[2 * k + 1];
    if ((y1 > y) == (y2 > y)) continue;
    if (x < polygon[2 * before] + (polygon[2 * k] - polygon[2 * before]) * (y - y1) / (y2 - y1)) odd = !odd;
  }
  return odd;
}

/// The road that pixels of a region meet.
std::vector<RoadPoint> road_in_region(const World& world, const CameraMoment& moment, const CameraPreset& camera) {
  constexpr int kStridePx = 12;
  std::vector<RoadPoint> points;
  for (int y = 0; y < camera.camera->height(); y += kStridePx) {
    for (int x = 0; x < camera.camera->width(); x += kStridePx) {
      if (!inside(camera.region_px, x, y)) continue;
      const auto ray = camera.camera->ray({static_cast<double>(x), static_cast<double>(y)});
      if (!ray) continue;
      const auto hit = world.scene.hit(moment.world_from_cam.translation, moment.world_from_cam.rotation * *ray);
      if (hit && is_road(hit->material)) points.push_back({static_cast<double>(hit->distance_m) * *ray, 1.0});
    }
  }
  return points;
}

/// Least squares: m . X = 1 with m = n / h.
GroundPlane plane_of(const std::vector<RoadPoint>& points) {
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sums = Eigen::Vector3d::Zero();
  for (const RoadPoint& point : points) {
    moments += point.weight * point.in_cam * point.in_cam.transpose();
    sums += point.weight * point.in_cam;
  }
  const Eigen::Vector3d m = moments.ldlt().solve(sums);
  return {m.normalized(), 1.0 / m.norm()};
}

World world_about(const Path& path, const CameraPreset& camera, std::uint64_t seed) {
  WorldOptions options = camera.options.world;
  options.seed = seed;
  return make_world(path, options);
}

constexpr double kSPerMs = 1e-3;
constexpr double kShortestIntervalS = 1e-4;

}  // namespace

SimulatedDrive drive_along(const Route& route, const CameraPreset& camera, std::uint64_t seed) {
  SimulatedDrive drive{camera, seed, world_about(route.path, camera, seed), {}, true};
  drive.moments = moments_of_route(drive.world.surface, route, camera.options.rig, camera.options.rate_hz,
                                   kSPerMs * camera.options.shutter_ms, seed);
  return drive;
}

Result<SimulatedDrive> drive_along(const Trajectory& poses, const std::vector<double>& times_s,
                                   const CameraPreset& camera, std::uint64_t seed) {
  if (times_s.size() != poses.world_from_cam.size()) {
    return Error{ErrorCode::kBadInput, fmt::format("{} times for {} poses", times_s.size(), poses.size())};
  }
  const double shortest_s = std::max(kShortestIntervalS, kSPerMs * camera.options.shutter_ms);
  for (std::size_t k = 1; k < times_s.size(); ++k) {
    if (times_s[k] - times_s[k - 1] >= shortest_s) continue;
    return Error{
        ErrorCode::kBadInput,
        fmt::format("time {} is {} s and the one before {} s; {} s is the least there may be between them (the "
                    "shutter is open for {} ms)",
                    k, times_s[k], times_s[k - 1], shortest_s, camera.options.shutter_ms)};
  }
  const Result<LaidRoad> road = lay_road(poses, camera.options.rig, camera.options.world.profile);
  if (!road) return road.error();
  return SimulatedDrive{camera, seed, world_about(road->path, camera, seed),
                        moments_of_laid_road(*road, times_s, kSPerMs * camera.options.shutter_ms), false};
}

RoadTruth road_truth(const SimulatedDrive& drive, std::size_t frame) {
  const CameraMoment& moment = drive.moments[frame];
  const RoadSurface& surface = drive.world.surface;
  const Eigen::Vector3d& camera = moment.world_from_cam.translation;
  const Eigen::Vector3d beneath(camera.x(), surface.ground_y(camera.x(), camera.z()), camera.z());
  RoadTruth truth;
  truth.height_m = surface.ground_normal(camera.x(), camera.z()).dot(camera - beneath);
  const std::vector<RoadPoint> points =
      drive.camera.region_px.empty() ? road_ahead(surface, moment) : road_in_region(drive.world, moment, drive.camera);
  constexpr std::size_t kFewest = 3;
  truth.has_plane = points.size() >= kFewest;
  if (truth.has_plane) truth.plane = plane_of(points);
  return truth;
}

}  // namespace groundscale
