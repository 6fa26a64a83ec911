#include <opengv/absolute_pose/CentralAbsoluteAdapter.hpp>
#include <opengv/absolute_pose/methods.hpp>

#include "groundscale/mapping/p3p_internal.hpp"

namespace groundscale {

std::vector<RigidTransform> three_point_poses(const std::array<Eigen::Vector3d, 3>& points_in_world,
                                              const std::array<Eigen::Vector3d, 3>& rays) {
  const opengv::points_t points(points_in_world.begin(), points_in_world.end());
  const opengv::bearingVectors_t bearings(rays.begin(), rays.end());
  const opengv::absolute_pose::CentralAbsoluteAdapter adapter(bearings, points);
  std::vector<RigidTransform> poses;
  for (const opengv::transformation_t& world_from_cam : opengv::absolute_pose::p3p_kneip(adapter)) {
    if (!world_from_cam.allFinite()) continue;
    poses.push_back(RigidTransform{world_from_cam.leftCols<3>(), world_from_cam.col(3)}.inverse());
  }
  return poses;
}

}  // namespace groundscale
