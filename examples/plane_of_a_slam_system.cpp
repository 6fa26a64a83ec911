// A SLAM system of one's own hands over road points seen from two of its views and gets the road's plane, and with the
// camera's height the scale of its map. Here the views and the points are made up: the map's unit is 2.5 m.
#include <cstdio>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/plane/methods.hpp"

int main() {
  using namespace groundscale;
  const auto camera = PinholeCamera::create({.fx = 718.0, .fy = 718.0, .cx = 607.0, .cy = 185.0}, 1241, 376);
  if (!camera) return 1;
  constexpr double kMetresPerUnit = 2.5;
  constexpr double kCameraHeightM = 1.65;
  const double height = kCameraHeightM / kMetresPerUnit;

  RoadObservations observations;
  observations.camera = *camera;
  observations.cam_from_reference = {RigidTransform{}, RigidTransform{Eigen::Matrix3d::Identity(), {0.0, 0.0, -0.4}}};
  std::int64_t id = 0;
  for (double z = 2.6; z < 8.0; z += 0.3) {
    for (double x = -0.8; x <= 0.8; x += 0.2) {
      const Eigen::Vector3d point(x, height, z);
      const auto first = (*camera)->project(point);
      const auto second = (*camera)->project(observations.cam_from_reference[1] * point);
      if (first && second) observations.points.push_back({id++, *first, {RoadSight{1, *second}}});
    }
  }

  Rng rng(0);
  const auto measured = estimate_plane_sparse(observations, {}, rng);
  if (!measured) {
    std::fprintf(stderr, "%s\n", measured.error().message.c_str());
    return 1;
  }
  std::printf("height in map units %.4f: one unit is %.4f m\n", measured->plane.height,
              kCameraHeightM / measured->plane.height);
  return 0;
}
