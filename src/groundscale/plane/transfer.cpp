#include <Eigen/Geometry>

#include "groundscale/geometry/so3.hpp"
#include "groundscale/plane/transfer_internal.hpp"

namespace groundscale {

std::vector<Transfer> transfers_of(const RoadObservations& observations) {
  std::vector<Transfer> transfers;
  for (std::size_t i = 0; i < observations.points.size(); ++i) {
    const RoadPoint& point = observations.points[i];
    const auto ray1 = observations.camera->ray(point.pixel_in_reference);
    if (!ray1) continue;
    for (const RoadSight& sight : point.sights) {
      const auto ray2 = observations.camera->ray(sight.pixel);
      if (!ray2) continue;
      transfers.push_back(
          {static_cast<int>(i), sight.view, point.pixel_in_reference, sight.pixel, *ray1, *ray2, point.weight});
    }
  }
  return transfers;
}

std::optional<TransferError> transfer_error(const Camera& camera, const RigidTransform& cam2_from_cam1,
                                            const Eigen::Vector3d& m, const Transfer& transfer) {
  const Eigen::Matrix3d& rotation = cam2_from_cam1.rotation;
  const Eigen::Vector3d& t = cam2_from_cam1.translation;
  // H ray1 = R ray1 + t (m . ray1).
  const Eigen::Vector3d moved = rotation * transfer.ray1 + t * m.dot(transfer.ray1);
  Eigen::Matrix<double, 2, 3> by_ray;
  const auto pixel2 = camera.project(moved, &by_ray);
  if (!pixel2) return std::nullopt;
  TransferError error;
  error.forward = transfer.pixel2 - *pixel2;
  error.forward_by_m = -(by_ray * t) * transfer.ray1.transpose();

  // H^-1 ray2 = v - s (m . v) / (1 + m . s) with v = R^T ray2, s = R^T t (Sherman, Morrison). Times (1 + m . s), which
  // is positive for a camera above the plane, the ray is the same: v (1 + m . s) - s (m . v).
  const Eigen::Vector3d v = rotation.transpose() * transfer.ray2;
  const Eigen::Vector3d s = rotation.transpose() * t;
  const double denominator = 1.0 + m.dot(s);
  if (!(denominator > 0.0)) return std::nullopt;
  const Eigen::Vector3d back = v * denominator - s * m.dot(v);
  const auto pixel1 = camera.project(back, &by_ray);
  if (!pixel1) return std::nullopt;
  error.backward = transfer.pixel1 - *pixel1;
  const Eigen::Matrix3d back_by_m = v * s.transpose() - s * v.transpose();
  error.backward_by_m = -by_ray * back_by_m;
  return error;
}

std::optional<Eigen::Matrix<double, 2, 5>> forward_by_motion(const Camera& camera, const RigidTransform& cam2_from_cam1,
                                                             const Eigen::Vector3d& m, const Transfer& transfer) {
  const Eigen::Vector3d turned = cam2_from_cam1.rotation * transfer.ray1;
  const double inverse_depth = m.dot(transfer.ray1);
  Eigen::Matrix<double, 2, 3> by_ray;
  if (!camera.project(turned + cam2_from_cam1.translation * inverse_depth, &by_ray)) return std::nullopt;
  Eigen::Matrix<double, 3, 5> ray_by_motion;
  ray_by_motion.leftCols<3>() = -skew(turned);
  ray_by_motion.rightCols<2>() = tangents_of(cam2_from_cam1.translation) * inverse_depth;
  return -by_ray * ray_by_motion;
}

}  // namespace groundscale
