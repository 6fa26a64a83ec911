#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/core/result.hpp"
#include "groundscale/geometry/rigid_transform.hpp"

namespace groundscale {

/// X_target = scale * rotation X_source + translation.
struct Similarity {
  double scale = 1.0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return scale * (rotation * point) + translation; }
};

/// Least-squares alignment of two lists of corresponding points, sum |target_i - S source_i|^2 (Umeyama 1991).
/// @param with_scale false fixes scale at 1.
/// @return kTooFewMatches for fewer than 3 points or points that lie on one spot.
Result<Similarity> align_points(const std::vector<Eigen::Vector3d>& source, const std::vector<Eigen::Vector3d>& target,
                                bool with_scale);

}  // namespace groundscale
