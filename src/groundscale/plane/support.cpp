#include <algorithm>
#include <cmath>
#include <iterator>

#include "groundscale/geometry/essential.hpp"
#include "groundscale/plane/support_internal.hpp"

namespace groundscale {

std::vector<Transfer> consistent_transfers(const RoadObservations& observations, const PlaneOptions& options) {
  std::vector<Eigen::Matrix3d> essentials;
  for (const RigidTransform& pose : observations.cam_from_reference) essentials.push_back(essential_matrix(pose));
  const double max_error_rad = options.max_epipolar_px / observations.camera->focal_px();
  std::vector<Transfer> kept;
  for (const Transfer& transfer : transfers_of(observations)) {
    const Eigen::Matrix3d& essential = essentials[static_cast<std::size_t>(transfer.view)];
    if (std::abs(epipolar_error_rad(essential, transfer.ray1, transfer.ray2)) <= max_error_rad)
      kept.push_back(transfer);
  }
  return kept;
}

std::vector<Transfer> of_view(const std::vector<Transfer>& transfers, int view) {
  std::vector<Transfer> chosen;
  std::copy_if(transfers.begin(), transfers.end(), std::back_inserter(chosen),
               [view](const Transfer& transfer) { return transfer.view == view; });
  return chosen;
}

PlaneSupport support_of_plane(const Camera& camera, std::span<const RigidTransform> cam_from_reference,
                              const std::vector<Transfer>& transfers, const Eigen::Vector3d& m, double max_error_px) {
  PlaneSupport support;
  double squares = 0.0;
  for (const Transfer& transfer : transfers) {
    const RigidTransform& pose = cam_from_reference[static_cast<std::size_t>(transfer.view)];
    const auto error = transfer_error(camera, pose, m, transfer);
    if (!error || error->forward.norm() > max_error_px || error->backward.norm() > max_error_px) continue;
    support.transfers.push_back(transfer);
    squares += error->forward.squaredNorm();
    if (support.points.empty() || support.points.back() != transfer.point) support.points.push_back(transfer.point);
  }
  if (!support.transfers.empty()) support.rms_px = std::sqrt(squares / static_cast<double>(support.transfers.size()));
  return support;
}

Result<void> check_baseline(const RoadObservations& observations) {
  constexpr double kMinBaseline = 1e-9;
  if (observations.cam_from_reference[1].translation.norm() >= kMinBaseline) return {};
  return Error{ErrorCode::kDegenerateMotion, "no baseline between the two views"};
}

PlaneMeasurement measurement_of(const RoadObservations& observations, const GroundPlane& plane,
                                const PlaneOptions& options) {
  PlaneMeasurement measurement;
  measurement.plane = plane;
  measurement.initial_plane = plane;
  const PlaneSupport support =
      support_of_plane(*observations.camera, observations.cam_from_reference,
                       consistent_transfers(observations, options), plane.inverse_form(), options.max_error_px);
  measurement.inliers = support.points;
  measurement.rms_px = support.rms_px;
  return measurement;
}

}  // namespace groundscale
