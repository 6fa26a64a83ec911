#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "groundscale/core/result.hpp"
#include "groundscale/plane/methods.hpp"
#include "groundscale/plane/transfer_internal.hpp"

namespace groundscale {

/// Transfers that agree with the motion of their views.
std::vector<Transfer> consistent_transfers(const RoadObservations& observations, const PlaneOptions& options);

/// Those into one view.
std::vector<Transfer> of_view(const std::vector<Transfer>& transfers, int view);

/// Road points that lie on a plane.
struct PlaneSupport {
  std::vector<Transfer> transfers;
  std::vector<int> points;  ///< Ascending, each once.
  double rms_px = 0.0;      ///< Forward.
};

/// Transfers with an error of at most max_error_px each way for the plane m = n / h.
PlaneSupport support_of_plane(const Camera& camera, std::span<const RigidTransform> cam_from_reference,
                              const std::vector<Transfer>& transfers, const Eigen::Vector3d& m, double max_error_px);

/// @return kDegenerateMotion where view 1 has no baseline.
Result<void> check_baseline(const RoadObservations& observations);

/// A plane that wasn't found by the transfer error, as a measurement: start, inliers and rms; covariance still zero.
PlaneMeasurement measurement_of(const RoadObservations& observations, const GroundPlane& plane,
                                const PlaneOptions& options);

}  // namespace groundscale
