#include <cmath>
#include <numbers>

#include "groundscale/plane/normal_prior_internal.hpp"

namespace groundscale {
namespace {

double information_of(double sd_deg) {
  const double sd_rad = sd_deg * std::numbers::pi / 180.0;
  return 1.0 / (sd_rad * sd_rad);
}

}  // namespace

Eigen::Matrix3d normal_by_m(const Eigen::Vector3d& m) {
  const Eigen::Vector3d n = m.normalized();
  return (Eigen::Matrix3d::Identity() - n * n.transpose()) / m.norm();
}

NormalPrior::NormalPrior(const RoadObservations& observations, const PlaneOptions& options) {
  if (!observations.expected_normal.isZero() && options.normal_prior_deg > 0.0) {
    expected_ = observations.expected_normal;
    expected_information_ = information_of(observations.normal_prior_factor * options.normal_prior_deg);
  }
  if (!observations.driving_direction.isZero() && options.direction_prior_deg > 0.0) {
    direction_ = observations.driving_direction;
    direction_information_ = information_of(options.direction_prior_deg);
  }
}

double NormalPrior::cost(const Eigen::Vector3d& m) const {
  const Eigen::Vector3d n = m.normalized();
  return 0.5 * expected_information_ * (n - expected_).squaredNorm() +
         0.5 * direction_information_ * std::pow(n.dot(direction_), 2);
}

Eigen::Vector3d NormalPrior::gradient(const Eigen::Vector3d& m) const {
  const Eigen::Vector3d n = m.normalized();
  return normal_by_m(m).transpose() *
         (expected_information_ * (n - expected_) + direction_information_ * n.dot(direction_) * direction_);
}

Eigen::Matrix3d NormalPrior::hessian(const Eigen::Vector3d& m) const {
  const Eigen::Matrix3d by_m = normal_by_m(m);
  return by_m.transpose() *
         (expected_information_ * Eigen::Matrix3d::Identity() +
          direction_information_ * direction_ * direction_.transpose()) *
         by_m;
}

}  // namespace groundscale
