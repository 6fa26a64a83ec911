#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/geometry/essential.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/plane/methods.hpp"
#include "groundscale/plane/plane_homography_internal.hpp"
#include "groundscale/plane/refine_internal.hpp"
#include "groundscale/plane/transfer_internal.hpp"

namespace groundscale {
namespace {

/// Transfers that agree with the motion of their views.
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

struct Inliers {
  std::vector<Transfer> transfers;
  std::vector<int> points;  ///< Ascending, each once.
  double rms_px = 0.0;      ///< Forward.
};

Inliers inliers_of_plane(const RoadObservations& observations, const std::vector<Transfer>& transfers,
                         const Eigen::Vector3d& m, double max_error_px) {
  Inliers inliers;
  double squares = 0.0;
  for (const Transfer& transfer : transfers) {
    const RigidTransform& pose = observations.cam_from_reference[static_cast<std::size_t>(transfer.view)];
    const auto error = transfer_error(*observations.camera, pose, m, transfer);
    if (!error || error->forward.norm() > max_error_px || error->backward.norm() > max_error_px) continue;
    inliers.transfers.push_back(transfer);
    squares += error->forward.squaredNorm();
    if (inliers.points.empty() || inliers.points.back() != transfer.point) inliers.points.push_back(transfer.point);
  }
  if (!inliers.transfers.empty()) inliers.rms_px = std::sqrt(squares / static_cast<double>(inliers.transfers.size()));
  return inliers;
}

}  // namespace

Result<PlaneMeasurement> estimate_plane_sparse(const RoadObservations& observations, const PlaneOptions& options,
                                               Rng& rng) {
  GS_CHECK(observations.camera != nullptr && observations.cam_from_reference.size() >= 2, "two views and their camera");
  const RigidTransform& motion = observations.cam_from_reference[1];
  const std::vector<Transfer> transfers = consistent_transfers(observations, options);
  const auto homography = ransac_homography(*observations.camera, of_view(transfers, 1), options, rng);
  if (!homography) return homography.error();
  const auto initial = plane_of_homography(*homography, motion);
  if (!initial) return initial.error();

  PlaneMeasurement measurement;
  measurement.initial_plane = *initial;
  Eigen::Vector3d m = initial->inverse_form();
  Inliers inliers;
  // The linear start lets in few points where the motion is small; each round lets in those of the better plane.
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    const double slack = round == 0 ? 2.0 : 1.0;
    inliers = inliers_of_plane(observations, transfers, m, slack * options.max_error_px);
    if (static_cast<int>(inliers.points.size()) < options.min_inliers) {
      return Error{ErrorCode::kTooFewMatches,
                   fmt::format("{} of {} road matches lie on one plane, {} needed", inliers.points.size(),
                               observations.points.size(), options.min_inliers)};
    }
    m = refine_plane(observations, inliers.transfers, m, options);
    if (!m.allFinite() || !(m.norm() > 0.0)) return Error{ErrorCode::kNotGround, "the plane runs to infinity"};
  }
  inliers = inliers_of_plane(observations, transfers, m, options.max_error_px);
  measurement.plane = GroundPlane::from_inverse_form(m);
  measurement.covariance_of_m = covariance_of_plane(observations, inliers.transfers, m, options);
  measurement.inliers = inliers.points;
  measurement.rms_px = inliers.rms_px;
  if (static_cast<int>(measurement.inliers.size()) < options.min_inliers || !measurement.covariance_of_m.allFinite()) {
    return Error{ErrorCode::kTooFewMatches,
                 fmt::format("{} of {} road matches lie on the refined plane, {} needed", inliers.points.size(),
                             observations.points.size(), options.min_inliers)};
  }
  return measurement;
}

}  // namespace groundscale
