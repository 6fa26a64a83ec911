#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "groundscale/camera/camera.hpp"
#include "groundscale/camera/parameters.hpp"
#include "groundscale/camera/pinhole.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/mapping/drive_tracks.hpp"

namespace groundscale::internal {

/// For tests: a camera like KITTI's, a little distorted.
inline CameraPtr true_pinhole() {
  return PinholeCamera::create({.fx = 718.0, .fy = 718.0, .cx = 607.0, .cy = 185.0, .k1 = 0.012}, 1241, 376).value();
}

/// The camera with errors in its radial coefficient and its row.
inline CameraPtr off(const CameraPtr& camera, double radial, double row_px) {
  const double old_radial = value_of(CameraParameter::kRadial, *camera);
  const auto bent = with_value(CameraParameter::kRadial, old_radial + radial, *camera);
  return with_value(CameraParameter::kRow, value_of(CameraParameter::kRow, **bent) + row_px, **bent).value();
}

struct Street {
  int views = 60;
  double turn_rad = 1.2;  ///< Of the whole drive, in its middle third.
  double noise_px = 0.3;
  int points = 1500;
};

/// A drive with a bend, a metre a view, its tracks as a camera sees them, poses exact.
inline DriveTracks drive_along(const Street& street, const Camera& camera, Rng& rng) {
  DriveTracks drive;
  RigidTransform world_from_cam;
  const int third = street.views / 3;
  for (int v = 0; v < street.views; ++v) {
    drive.views.push_back({v, world_from_cam.inverse()});
    const bool bend = v >= third && v < 2 * street.views / 3;
    const double turn = bend ? street.turn_rad / third : 0.0;
    // A little up and down, as cars do.
    const RigidTransform step{exp_so3({0.002 * std::sin(0.7 * v), turn, 0.001 * std::cos(0.9 * v)}),
                              {0.0, 0.01 * std::sin(0.5 * v), 1.0}};
    world_from_cam = world_from_cam * step;
  }
  while (static_cast<int>(drive.tracks.size()) < street.points) {
    const auto first = static_cast<std::size_t>(rng.index(street.views - 3));
    const double row = rng.uniform(0.0, camera.height() - 1.0);
    const auto ray = camera.ray({rng.uniform(0.0, camera.width() - 1.0), row});
    if (!ray) continue;
    const Eigen::Vector3d in_cam = *ray * (rng.uniform(6.0, 30.0) / std::max(0.3, ray->z()));
    const Eigen::Vector3d point = drive.views[first].cam_from_world.inverse() * in_cam;
    DriveTracks::Track track;
    track.id = static_cast<TrackId>(drive.tracks.size());
    for (std::size_t v = first; v < drive.views.size() && v < first + 20; ++v) {
      const auto seen = camera.project(drive.views[v].cam_from_world * point);
      if (!seen || !camera.contains(*seen)) break;
      const double x = rng.normal();
      track.sights.push_back({static_cast<int>(v), *seen + street.noise_px * Eigen::Vector2d(x, rng.normal())});
    }
    if (track.sights.size() >= 3) drive.tracks.push_back(std::move(track));
  }
  return drive;
}

}  // namespace groundscale::internal
