#pragma once

// A made-up road in two views, for the tests of all plane methods.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "groundscale/camera/kannala_brandt.hpp"
#include "groundscale/camera/pinhole.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/plane/observations.hpp"

namespace groundscale {

inline const RigidTransform kTestMotion{exp_so3({0.001, 0.02, -0.001}), Eigen::Vector3d(0.03, 0.01, -1.0).normalized()};
/// 1.65 m over the road with steps of 1 m, looking down by 1 degree.
inline const GroundPlane kTestRoad{Eigen::Vector3d(0.01, 1.0, 0.0175).normalized(), 1.65};

inline CameraPtr test_camera(double k1 = 0.0) {
  return PinholeCamera::create({.fx = 718.0, .fy = 718.0, .cx = 607.0, .cy = 185.0, .k1 = k1}, 1241, 376).value();
}

inline CameraPtr test_fisheye() {
  return KannalaBrandtCamera::create(
             {.fx = 350.0, .fy = 350.0, .cx = 640.0, .cy = 360.0, .k1 = 0.02, .k2 = -0.004, .k3 = 0.0, .k4 = 0.0}, 1280,
             720)
      .value();
}

struct TestRoadOptions {
  double noise_px = 0.0;     ///< In the second view.
  double wrong_share = 0.0;  ///< Of points that stand above the road.
  int count = 250;
  int scene_count = 0;  ///< Of which half lie on the road and half on houses to both sides.
  RigidTransform motion = kTestMotion;
};

/// Points of the road ahead in two views.
inline RoadObservations test_road(const CameraPtr& camera, const TestRoadOptions& options, Rng& rng) {
  RoadObservations observations;
  observations.camera = camera;
  observations.cam_from_reference = {RigidTransform{}, options.motion};
  const auto noisy = [&](const Eigen::Vector3d& point) {
    const Eigen::Vector2d noise(rng.normal() * options.noise_px, rng.normal() * options.noise_px);
    return Eigen::Vector2d(*camera->project(options.motion * point) + noise);
  };
  const auto on_road = [&] {
    const Eigen::Vector3d ray(rng.uniform(-0.3, 0.3), rng.uniform(0.08, 0.25), 1.0);
    return Eigen::Vector3d(ray * kTestRoad.height / kTestRoad.normal_in_cam.dot(ray));
  };
  while (static_cast<int>(observations.points.size()) < options.count) {
    Eigen::Vector3d point = on_road();
    if (rng.uniform() < options.wrong_share) point *= rng.uniform(0.7, 0.9);
    observations.points.push_back(
        {static_cast<std::int64_t>(observations.points.size()), *camera->project(point), {{1, noisy(point)}}});
  }
  for (int i = 0; i < options.scene_count; ++i) {
    const double side = rng.uniform() < 0.5 ? -1.0 : 1.0;
    const Eigen::Vector3d house(side * rng.uniform(6.0, 7.0), rng.uniform(-4.0, 1.0), rng.uniform(12.0, 40.0));
    const Eigen::Vector3d point = i % 2 == 0 ? on_road() : house;
    observations.scene.push_back({*camera->project(point), noisy(point)});
  }
  return observations;
}

inline double tilt_deg(const GroundPlane& plane) {
  return std::atan2(plane.normal_in_cam.cross(kTestRoad.normal_in_cam).norm(),
                    plane.normal_in_cam.dot(kTestRoad.normal_in_cam)) *
         180.0 / std::numbers::pi;
}

}  // namespace groundscale
