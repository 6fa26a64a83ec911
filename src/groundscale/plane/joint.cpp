#include <array>

#include <fmt/format.h>

#include "groundscale/core/check.hpp"
#include "groundscale/plane/motion_refine_internal.hpp"
#include "groundscale/plane/plane_homography_internal.hpp"
#include "groundscale/plane/support_internal.hpp"

namespace groundscale {

Result<PlaneMeasurement> estimate_plane_joint(const RoadObservations& observations, const PlaneOptions& options,
                                              Rng& rng) {
  GS_CHECK(observations.camera != nullptr && observations.cam_from_reference.size() >= 2, "two views and their camera");
  const std::vector<Transfer> transfers = of_view(consistent_transfers(observations, options), 1);
  const auto homography = ransac_homography(*observations.camera, transfers, options, rng);
  if (!homography) return homography.error();
  MotionAndPlane found{observations.cam_from_reference[1], {}};
  const auto initial = plane_of_homography(*homography, found.cam2_from_cam1);
  if (!initial) return initial.error();
  found.m = initial->inverse_form();

  PlaneSupport support;
  const auto look_for_support = [&](double max_error_px) -> Result<void> {
    const std::array poses{RigidTransform{}, found.cam2_from_cam1};
    support = support_of_plane(*observations.camera, poses, transfers, found.m, max_error_px);
    if (static_cast<int>(support.points.size()) >= options.min_inliers) return {};
    return Error{ErrorCode::kTooFewMatches,
                 fmt::format("{} of {} road matches lie on one plane, {} needed", support.points.size(),
                             observations.points.size(), options.min_inliers)};
  };
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    const auto enough = look_for_support((round == 0 ? 2.0 : 1.0) * options.max_error_px);
    if (!enough) return enough.error();
    found = refine_motion_and_plane(observations, support.transfers, found, options);
    if (!found.m.allFinite() || !(found.m.norm() > 0.0)) {
      return Error{ErrorCode::kNotGround, "the plane runs to infinity"};
    }
  }
  if (const auto enough = look_for_support(options.max_error_px); !enough) return enough.error();
  PlaneMeasurement measurement;
  measurement.initial_plane = *initial;
  measurement.plane = GroundPlane::from_inverse_form(found.m);
  measurement.covariance_of_m = covariance_with_free_motion(observations, support.transfers, found, options, true);
  if (!measurement.covariance_of_m.allFinite()) {
    return Error{ErrorCode::kNotGround, "the road matches leave motion and plane open: they lie on one line"};
  }
  measurement.inliers = support.points;
  measurement.rms_px = support.rms_px;
  measurement.motion = {found.cam2_from_cam1.rotation, found.cam2_from_cam1.translation.normalized()};
  return measurement;
}

}  // namespace groundscale
