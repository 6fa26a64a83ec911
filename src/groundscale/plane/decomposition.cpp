#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "groundscale/core/check.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/plane/homography_decomposition.hpp"
#include "groundscale/plane/motion_refine_internal.hpp"
#include "groundscale/plane/plane_homography_internal.hpp"
#include "groundscale/plane/support_internal.hpp"

namespace groundscale {
namespace {

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

/// How far a solution is from what is known otherwise; normal 0 where nothing is known of it.
struct Mismatch {
  double normal_deg = 0.0, rotation_deg = 0.0, direction_deg = 0.0;
};

Mismatch mismatch_of(const HomographyDecomposition& solution, const RoadObservations& observations) {
  const RigidTransform& motion = observations.cam_from_reference[1];
  Mismatch mismatch;
  if (!observations.expected_normal.isZero()) {
    mismatch.normal_deg = angle_deg(solution.normal, observations.expected_normal);
  }
  mismatch.rotation_deg = rotation_angle(solution.rotation * motion.rotation.transpose()) * 180.0 / std::numbers::pi;
  mismatch.direction_deg = angle_deg(solution.translation, motion.translation);
  return mismatch;
}

/// The one solution that can be: the points lie in front of the camera on its plane, and of the two that are left by
/// that, the one nearer to the expected normal and to the given motion.
Result<HomographyDecomposition> prune(const std::vector<HomographyDecomposition>& solutions,
                                      const std::vector<Transfer>& transfers, const RoadObservations& observations,
                                      const DecompositionOptions& options) {
  const HomographyDecomposition* best = nullptr;
  Mismatch least;
  double least_sum = 0.0;
  for (const HomographyDecomposition& solution : solutions) {
    const auto visible = std::count_if(transfers.begin(), transfers.end(), [&](const Transfer& transfer) {
      return solution.normal.dot(transfer.ray1) > 0.0;
    });
    if (2 * visible <= static_cast<std::ptrdiff_t>(transfers.size())) continue;
    const Mismatch mismatch = mismatch_of(solution, observations);
    const double sum = mismatch.normal_deg + mismatch.rotation_deg + mismatch.direction_deg;
    if (best != nullptr && sum >= least_sum) continue;
    best = &solution;
    least = mismatch;
    least_sum = sum;
  }
  if (best == nullptr) return Error{ErrorCode::kNotGround, "no plane of the homography has the points in front of it"};
  if (least.normal_deg > options.max_normal_deg || least.rotation_deg > options.max_rotation_deg ||
      least.direction_deg > options.max_direction_deg) {
    return Error{ErrorCode::kNotGround,
                 fmt::format("the homography's nearest decomposition is off by {:.1f} deg in its normal, {:.1f} deg in "
                             "rotation and {:.1f} deg in the direction of motion",
                             least.normal_deg, least.rotation_deg, least.direction_deg)};
  }
  return *best;
}

}  // namespace

Result<PlaneMeasurement> estimate_plane_decomposition(const RoadObservations& observations, const PlaneOptions& options,
                                                      Rng& rng) {
  GS_CHECK(observations.camera != nullptr && observations.cam_from_reference.size() >= 2, "two views and their camera");
  if (const auto checked = check_baseline(observations); !checked) return checked.error();
  const std::vector<Transfer> transfers = of_view(consistent_transfers(observations, options), 1);
  const auto homography = ransac_homography(*observations.camera, transfers, options, rng);
  if (!homography) return homography.error();
  const auto solutions = options.decomposition.solver == DecompositionSolver::kNumeric
                             ? decompose_homography_numerically(*homography)
                             : decompose_homography(*homography);
  if (!solutions) return solutions.error();
  const auto solution = prune(*solutions, transfers, observations, options.decomposition);
  if (!solution) return solution.error();

  // |t| / h is the homography's; the unit of the result is the given |t|.
  const double baseline = observations.cam_from_reference[1].translation.norm();
  PlaneMeasurement measurement;
  measurement.plane = {solution->normal, baseline / solution->translation.norm()};
  measurement.initial_plane = measurement.plane;
  measurement.motion = {solution->rotation, solution->translation.normalized()};
  const MotionAndPlane found{{solution->rotation, baseline * solution->translation.normalized()},
                             measurement.plane.inverse_form()};
  const std::array poses{RigidTransform{}, found.cam2_from_cam1};
  const PlaneSupport support = support_of_plane(*observations.camera, poses, transfers, found.m, options.max_error_px);
  if (static_cast<int>(support.points.size()) < options.min_inliers) {
    return Error{ErrorCode::kTooFewMatches,
                 fmt::format("{} of {} road matches agree with the homography, {} needed", support.points.size(),
                             observations.points.size(), options.min_inliers)};
  }
  measurement.inliers = support.points;
  measurement.rms_px = support.rms_px;
  measurement.covariance_of_m = covariance_with_free_motion(observations, support.transfers, found, options, false);
  if (!measurement.covariance_of_m.allFinite()) {
    return Error{ErrorCode::kNotGround, "the road matches leave the homography open: they lie on one line"};
  }
  return measurement;
}

}  // namespace groundscale
