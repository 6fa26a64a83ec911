#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/plane/methods.hpp"
#include "groundscale/plane/transfer_internal.hpp"

namespace groundscale {

/// A point that leaves the camera's field costs as much as one that is this far off.
inline constexpr double kLostTransferPx = 100.0;

/// Weight of NormalPrior beside the sum of transfer errors in one direction, px^2; beside both directions twice that.
double prior_worth(const PlaneOptions& options);

/// m that minimises the symmetric transfer error of the transfers with a Huber loss, from a start nearby.
Eigen::Vector3d refine_plane(const RoadObservations& observations, const std::vector<Transfer>& transfers,
                             const Eigen::Vector3d& start, const PlaneOptions& options);

/// Formal covariance of m: forward and backward residuals are the same information, so it counts once; R and t
/// contribute through dm/d(R, t) of view 1.
Eigen::Matrix3d covariance_of_plane(const RoadObservations& observations, const std::vector<Transfer>& transfers,
                                    const Eigen::Vector3d& m, const PlaneOptions& options);

}  // namespace groundscale
