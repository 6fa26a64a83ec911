#pragma once

#include <Eigen/Core>

#include "groundscale/plane/methods.hpp"

namespace groundscale {

/// Derivative of n = m / |m| by m.
Eigen::Matrix3d normal_by_m(const Eigen::Vector3d& m);

/// What is known of the road's normal n = m / |m| besides its points, as part of a cost:
///   |n - e|^2 / (2 s_e^2) + (n.c)^2 / (2 s_c^2),
/// e = the expected normal, the mean of the drive, s_e = normal_prior_deg; c = the driving direction, s_c =
/// direction_prior_deg: what drives, drives along its road, up- and downhill too. Either may be missing.
class NormalPrior {
 public:
  NormalPrior() = default;  ///< Nothing is known.
  NormalPrior(const RoadObservations& observations, const PlaneOptions& options);

  double cost(const Eigen::Vector3d& m) const;
  /// Derivatives of the cost by m; the second one as Gauss and Newton have it.
  Eigen::Vector3d gradient(const Eigen::Vector3d& m) const;
  Eigen::Matrix3d hessian(const Eigen::Vector3d& m) const;

 private:
  Eigen::Vector3d expected_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction_ = Eigen::Vector3d::Zero();
  double expected_information_ = 0.0;  ///< 1 / s_e^2; 0: not known.
  double direction_information_ = 0.0;
};

}  // namespace groundscale
