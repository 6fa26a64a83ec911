#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Geometry>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/geometry/ground_plane.hpp"
#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/tracking/matches.hpp"
#include "groundscale/tracking/test_texture_internal.hpp"

/// Two views of a textured road for tests.
namespace groundscale::test_road {

inline const GroundPlane kRoad{Eigen::Vector3d(0.01, 1.0, 0.02).normalized(), 1.65};
inline const RigidTransform kMotion{Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY()).toRotationMatrix(),
                                    {0.02, 0.01, -0.8}};

inline CameraPtr camera() {
  return *PinholeCamera::create({.fx = 400.0, .fy = 400.0, .cx = 240.0, .cy = 60.0}, 480, 240);
}

/// Both views of a textured road by intersecting each pixel's ray with the plane; above the horizon is grey.
struct Views {
  Image first, second;
};

/// The road's point that a pixel of a camera shows, as coordinates in camera 1, metres.
inline Eigen::Vector2d on_road(double x, double y, const GroundPlane& road, const RigidTransform& cam1_from_cam) {
  const Eigen::Vector3d ray((x - 240.0) / 400.0, (y - 60.0) / 400.0, 1.0);
  const double slope = std::max(road.normal_in_cam.dot(ray), 0.03);  // no farther than 55 m
  const Eigen::Vector3d point = cam1_from_cam * Eigen::Vector3d(ray * (road.height / slope));
  return {point.x(), point.z()};
}

inline Views render() {
  // 0.3 m at the shortest: 5 px deep 9 m ahead, where points begin to be wanted, so that neither view aliases.
  const TestTexture texture(8, 0.3);
  const auto view = [&](const GroundPlane& road, const RigidTransform& cam1_from_cam) {
    return texture.render(480, 240, [&](int x, int y) { return on_road(x, y, road, cam1_from_cam); });
  };
  return {view(kRoad, {}), view(kRoad.seen_from(kMotion), kMotion.inverse())};
}

/// Median over the matches of the error in x and in y against the plane's own homography.
inline Eigen::Vector2d bias_of(const Matches& matches) {
  std::vector<double> dx, dy;
  for (const Match& match : matches) {
    const Eigen::Vector3d ray((match.pixel1.x() - 240.0) / 400.0, (match.pixel1.y() - 60.0) / 400.0, 1.0);
    const Eigen::Vector3d point2 = kMotion * Eigen::Vector3d(ray * (kRoad.height / kRoad.normal_in_cam.dot(ray)));
    dx.push_back(match.pixel2.x() - (400.0 * point2.x() / point2.z() + 240.0));
    dy.push_back(match.pixel2.y() - (400.0 * point2.y() / point2.z() + 60.0));
  }
  const auto middle = [](std::vector<double>& values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
  };
  return {middle(dx), middle(dy)};
}

}  // namespace groundscale::test_road
