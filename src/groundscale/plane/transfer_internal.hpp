#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "groundscale/plane/observations.hpp"

namespace groundscale {

/// One point in the reference view (1) and another one (2), as the transfer error needs it.
struct Transfer {
  int point = 0;
  int view = 0;
  Eigen::Vector2d pixel1, pixel2;
  Eigen::Vector3d ray1, ray2;
  double weight = 1.0;
};

/// All sights as transfers; points outside the camera's valid field are left out.
std::vector<Transfer> transfers_of(const RoadObservations& observations);

/// x2 - project(H ray1) and x1 - project(H^-1 ray2) with H = R + t m^T, stacked, and their derivative by m.
/// Nothing where a ray leaves the camera's valid field.
struct TransferError {
  Eigen::Vector2d forward, backward;
  Eigen::Matrix<double, 2, 3> forward_by_m, backward_by_m;
};
std::optional<TransferError> transfer_error(const Camera& camera, const RigidTransform& cam2_from_cam1,
                                            const Eigen::Vector3d& m, const Transfer& transfer);

/// Forward error's derivative by (rotation vector left of R, two tangents of t).
std::optional<Eigen::Matrix<double, 2, 5>> forward_by_motion(const Camera& camera, const RigidTransform& cam2_from_cam1,
                                                             const Eigen::Vector3d& m, const Transfer& transfer);

}  // namespace groundscale
