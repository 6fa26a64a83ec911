#include "groundscale/geometry/so3.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace groundscale {

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return matrix;
}

Eigen::Matrix3d exp_so3(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  // Below 1e-8 the quadratic term is beneath the precision of the identity.
  if (angle < 1e-8) return Eigen::Matrix3d::Identity() + skew(w);
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

Eigen::Vector3d log_so3(const Eigen::Matrix3d& rotation) {
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2.0 * q.vec();
  return q.vec() * (2.0 * std::atan2(sine, q.w()) / sine);
}

double rotation_angle(const Eigen::Matrix3d& rotation) {
  const Eigen::Vector3d axis_times_sine =
      0.5 * Eigen::Vector3d(rotation(2, 1) - rotation(1, 2), rotation(0, 2) - rotation(2, 0),
                            rotation(1, 0) - rotation(0, 1));
  return std::atan2(axis_times_sine.norm(), 0.5 * (rotation.trace() - 1.0));
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix) {
  // Newton's iteration for the polar decomposition, X <- (X + X^-T) / 2: quadratic, and cheaper to compile than an SVD.
  Eigen::Matrix3d x = matrix;
  constexpr int kMaxIterations = 20;
  for (int k = 0; k < kMaxIterations; ++k) {
    const Eigen::Matrix3d next = 0.5 * (x + x.inverse().transpose());
    const double change = (next - x).norm();
    x = next;
    if (change < 1e-15) break;
  }
  return x;
}

Eigen::Matrix<double, 3, 2> tangents_of(const Eigen::Vector3d& t) {
  int smallest = 0;
  t.cwiseAbs().minCoeff(&smallest);
  Eigen::Matrix<double, 3, 2> tangents;
  tangents.col(0) = t.cross(Eigen::Vector3d::Unit(smallest)).normalized();
  tangents.col(1) = t.cross(tangents.col(0)).normalized();
  return tangents;
}

}  // namespace groundscale
