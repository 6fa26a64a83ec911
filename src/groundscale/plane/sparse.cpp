#include <fmt/format.h>

#include "groundscale/plane/methods.hpp"
#include "groundscale/plane/plane_homography_internal.hpp"
#include "groundscale/plane/refine_internal.hpp"
#include "groundscale/plane/support_internal.hpp"

namespace groundscale {

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
  const bool predicted = options.start == PlaneStart::kPredicted && observations.predicted_plane;
  Eigen::Vector3d m = predicted ? observations.predicted_plane->inverse_form() : initial->inverse_form();
  PlaneSupport inliers;
  // The linear start lets in few points where the motion is small; each round lets in those of the better plane.
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    const double slack = round == 0 ? 2.0 : 1.0;
    inliers = support_of_plane(*observations.camera, observations.cam_from_reference, transfers, m,
                               slack * options.max_error_px);
    if (static_cast<int>(inliers.points.size()) < options.min_inliers) {
      return Error{ErrorCode::kTooFewMatches,
                   fmt::format("{} of {} road matches lie on one plane, {} needed", inliers.points.size(),
                               observations.points.size(), options.min_inliers)};
    }
    m = refine_plane(observations, inliers.transfers, m, options);
    if (!m.allFinite() || !(m.norm() > 0.0)) return Error{ErrorCode::kNotGround, "the plane runs to infinity"};
  }
  inliers = support_of_plane(*observations.camera, observations.cam_from_reference, transfers, m, options.max_error_px);
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
