#pragma once

#include <algorithm>

#include <Eigen/Core>

#include "groundscale/camera/kannala_brandt.hpp"
#include "groundscale/camera/pinhole.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/mapping/bundle_adjustment.hpp"

namespace groundscale {

enum class TestCamera { kPinhole, kDistorted, kFisheye };

inline CameraPtr test_camera(TestCamera kind) {
  if (kind == TestCamera::kFisheye) {
    return KannalaBrandtCamera::create({.fx = 340.0, .fy = 342.0, .cx = 640.0, .cy = 400.0, .k1 = -0.02, .k2 = 0.003},
                                       1280, 800)
        .value();
  }
  PinholeParameters parameters{.fx = 700.0, .fy = 705.0, .cx = 620.0, .cy = 188.0};
  if (kind == TestCamera::kDistorted) {
    parameters.k1 = -0.1;
    parameters.k2 = 0.01;
    parameters.p1 = 1e-3;
    parameters.p2 = -2e-3;
  }
  return PinholeCamera::create(parameters, 1241, 376).value();
}

inline Eigen::Vector3d normal3(Rng& rng) {
  const double x = rng.normal();
  const double y = rng.normal();
  return {x, y, rng.normal()};
}

inline Eigen::Vector2d normal2(Rng& rng) {
  const double x = rng.normal();
  return {x, rng.normal()};
}

/// A point of a street in front of a camera at the origin, seen by it.
inline Eigen::Vector3d street_point(const Camera& camera, Rng& rng) {
  for (;;) {
    const double z = rng.uniform(6.0, 45.0);
    const double x = rng.uniform(-0.6, 0.6) * z;
    const Eigen::Vector3d point(x, rng.uniform(-0.2, 0.2) * z, z);
    const auto pixel = camera.project(point);
    if (pixel && camera.contains(*pixel)) return point;
  }
}

struct TestStreet {
  int views = 12;
  int fixed = 4;  ///< The first of them.
  int points = 150;
  int longest_track = 7;
  double noise_px = 0.0;
};

/// The truth of a drive along z in a bend, a metre a view, with noise in the pixels.
inline Bundle street(const CameraPtr& camera, const TestStreet& size, Rng& rng) {
  Bundle bundle;
  bundle.camera = camera;
  for (int v = 0; v < size.views; ++v) {
    const RigidTransform world_from_cam{exp_so3({0.0, 0.01 * v, 0.0}), {0.005 * v * v, 0.0, 1.0 * v}};
    bundle.views.push_back({world_from_cam.inverse(), v < size.fixed});
  }
  while (static_cast<int>(bundle.points_in_world.size()) < size.points) {
    const Eigen::Vector3d point = street_point(*camera, rng);
    const int begin = rng.index(size.views - 1);
    const int index = static_cast<int>(bundle.points_in_world.size());
    const std::size_t before = bundle.observations.size();
    for (int v = begin; v < std::min(size.views, begin + size.longest_track); ++v) {
      const auto pixel = camera->project(bundle.views[static_cast<std::size_t>(v)].cam_from_world * point);
      if (!pixel || !camera->contains(*pixel)) continue;
      bundle.observations.push_back({v, index, *pixel + size.noise_px * normal2(rng)});
    }
    if (bundle.observations.size() < before + 2) {
      bundle.observations.resize(before);
      continue;
    }
    bundle.points_in_world.push_back(point);
  }
  return bundle;
}

/// Moves the free views by some pixels and all points along their way by `point_share`.
inline void disturb(Bundle& bundle, double rotation_rad, double translation_m, double point_share, Rng& rng) {
  for (BundleView& view : bundle.views) {
    if (view.fixed) continue;
    view.cam_from_world.rotation = exp_so3(rotation_rad * normal3(rng)) * view.cam_from_world.rotation;
    view.cam_from_world.translation += translation_m * normal3(rng);
  }
  for (Eigen::Vector3d& point : bundle.points_in_world) point *= 1.0 + point_share * rng.normal();
}

}  // namespace groundscale
