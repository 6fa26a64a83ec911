#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/plane/methods.hpp"
#include "groundscale/plane/transfer_internal.hpp"

namespace groundscale {

/// A motion and a plane: together the eight numbers of a homography, since only |t| / h counts. |t| stays as it is.
struct MotionAndPlane {
  RigidTransform cam2_from_cam1;
  Eigen::Vector3d m = Eigen::Vector3d::Zero();
};

/// Both that minimise the symmetric transfer error of the transfers (all of view 1) with a Huber loss, and the prior of
/// the normal as in `refine_plane`, from a start nearby (Zhou, Dai, Li 2019, eq. 5).
MotionAndPlane refine_motion_and_plane(const RoadObservations& observations, const std::vector<Transfer>& transfers,
                                       const MotionAndPlane& start, const PlaneOptions& options);

/// Formal covariance of m where R and t are as free as m, with or without the prior of the normal. Not finite where the
/// transfers leave any of the eight numbers open.
Eigen::Matrix3d covariance_with_free_motion(const RoadObservations& observations,
                                            const std::vector<Transfer>& transfers, const MotionAndPlane& at,
                                            const PlaneOptions& options, bool with_prior);

/// Backward error's derivative by (rotation vector left of R, two tangents of t), as `forward_by_motion`.
std::optional<Eigen::Matrix<double, 2, 5>> backward_by_motion(const Camera& camera,
                                                              const RigidTransform& cam2_from_cam1,
                                                              const Eigen::Vector3d& m, const Transfer& transfer);

}  // namespace groundscale
