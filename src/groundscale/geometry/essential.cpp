#include "groundscale/geometry/essential.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "groundscale/geometry/so3.hpp"

namespace groundscale {

Eigen::Matrix3d essential_matrix(const RigidTransform& cam2_from_cam1) {
  return skew(cam2_from_cam1.translation) * cam2_from_cam1.rotation;
}

double epipolar_error_rad(const Eigen::Matrix3d& essential, const Eigen::Vector3d& ray1, const Eigen::Vector3d& ray2) {
  const Eigen::Vector3d normal2 = essential * ray1;
  const Eigen::Vector3d normal1 = essential.transpose() * ray2;
  const double lengths = std::sqrt(normal1.squaredNorm() + normal2.squaredNorm());
  return lengths > 0.0 ? ray2.dot(normal2) / lengths : 0.0;
}

RayDepths triangulate_depths(const RigidTransform& cam2_from_cam1, const Eigen::Vector3d& ray1,
                             const Eigen::Vector3d& ray2) {
  const Eigen::Vector3d ray1_in_cam2 = cam2_from_cam1.rotation * ray1;
  const Eigen::Vector3d& t = cam2_from_cam1.translation;
  // Normal equations of [-R ray1, ray2] (d1, d2) = t.
  const double cosine = ray1_in_cam2.dot(ray2);
  const double determinant = 1.0 - cosine * cosine;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (determinant <= 0.0) return {kInfinity, kInfinity};
  const double along1 = -ray1_in_cam2.dot(t);
  const double along2 = ray2.dot(t);
  return {(along1 + cosine * along2) / determinant, (along2 + cosine * along1) / determinant};
}

}  // namespace groundscale
