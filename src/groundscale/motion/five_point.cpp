#include <Eigen/LU>
#include <Eigen/SVD>
#include <opengv/relative_pose/CentralRelativeAdapter.hpp>
#include <opengv/relative_pose/methods.hpp>

#include "groundscale/motion/five_point_internal.hpp"

namespace groundscale {

std::vector<Eigen::Matrix3d> five_point_essentials(const std::array<RayPair, 5>& pairs) {
  opengv::bearingVectors_t rays1;
  opengv::bearingVectors_t rays2;
  for (const RayPair& pair : pairs) {
    rays1.push_back(pair.ray1);
    rays2.push_back(pair.ray2);
  }
  opengv::relative_pose::CentralRelativeAdapter adapter(rays1, rays2);
  const opengv::essentials_t essentials = opengv::relative_pose::fivept_nister(adapter);
  std::vector<Eigen::Matrix3d> result;
  for (const auto& essential : essentials) {
    // OpenGV's is ray1 . E ray2 = 0.
    if (essential.allFinite()) result.emplace_back(essential.transpose());
  }
  return result;
}

std::array<RigidTransform, 4> motions_of_essential(const Eigen::Matrix3d& essential) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(essential, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  Eigen::Matrix3d v = svd.matrixV();
  if (u.determinant() < 0.0) u = -u;
  if (v.determinant() < 0.0) v = -v;
  Eigen::Matrix3d w;
  w << 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  const Eigen::Matrix3d first = u * w * v.transpose();
  const Eigen::Matrix3d second = u * w.transpose() * v.transpose();
  const Eigen::Vector3d t = u.col(2);
  return {RigidTransform{first, t}, RigidTransform{first, -t}, RigidTransform{second, t}, RigidTransform{second, -t}};
}

}  // namespace groundscale
