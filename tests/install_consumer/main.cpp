// Moves a point of the road by the plane's homography and by the motion itself: both must agree.
#include <cstdio>

#include <groundscale/geometry/ground_plane.hpp>

int main() {
  const groundscale::RigidTransform cam2_from_cam1{Eigen::Matrix3d::Identity(), {0.0, 0.0, -1.0}};
  const groundscale::GroundPlane road{{0.0, 1.0, 0.0}, 1.65};
  const Eigen::Vector3d point_in_cam1(1.0, 1.65, 8.0);
  const Eigen::Vector3d cam2_ray = groundscale::homography_of_plane(road, cam2_from_cam1) * point_in_cam1;
  const double error = (cam2_ray - cam2_from_cam1 * point_in_cam1).norm();
  std::printf("error %g\n", error);
  return error < 1e-12 ? 0 : 1;
}
