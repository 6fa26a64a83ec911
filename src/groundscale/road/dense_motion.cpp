// The methods that find the motion from the road's pixels too.
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "groundscale/geometry/so3.hpp"
#include "groundscale/road/dense.hpp"
#include "groundscale/road/road_alignment_internal.hpp"

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Whether the motion found is still that of the pair.
Result<void> check_motion(const RigidTransform& found, const RigidTransform& given) {
  constexpr double kMaxTurnDeg = 3.0;
  constexpr double kMaxDirectionDeg = 20.0;
  const double turn = rotation_angle(found.rotation * given.rotation.transpose());
  const Eigen::Vector3d& t = found.translation;
  const double direction = std::atan2(t.cross(given.translation).norm(), t.dot(given.translation));
  if (turn <= kMaxTurnDeg * kDegree && direction <= kMaxDirectionDeg * kDegree) return {};
  return Error{ErrorCode::kNotGround, "the motion of the aligned road runs away from that of the scene"};
}

RigidTransform of_unit_length(const RigidTransform& motion) {
  return {motion.rotation, motion.translation.normalized()};
}

/// Of m = n |t'|, n given and t' found.
Eigen::Matrix3d covariance_of_fixed(const Aligned& aligned, const Eigen::MatrixXd& covariance, double normal_sd_rad) {
  const Eigen::MatrixXd basis = basis_of(FreeParameters::kMotion, aligned.state);
  const PhotometricMatrix information = aligned.sums.information;
  const Eigen::MatrixXd own = basis.transpose() * information * basis;
  const Eigen::MatrixXd by_normal =
      -own.ldlt().solve(Eigen::MatrixXd(basis.transpose() * information.middleCols<3>(6)));
  const Eigen::Vector3d& n = aligned.state.m;
  const double length = aligned.state.motion.translation.norm();
  const Eigen::Vector3d direction = aligned.state.motion.translation / length;
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - n * n.transpose();
  const Eigen::Matrix3d m_by_normal =
      (length * Eigen::Matrix3d::Identity() + n * (direction.transpose() * by_normal.middleRows<3>(3))) * across;
  const double variance = direction.dot(covariance.block<3, 3>(3, 3) * direction);
  return n * variance * n.transpose() + normal_sd_rad * normal_sd_rad * m_by_normal * m_by_normal.transpose();
}

}  // namespace

Result<PlaneMeasurement> estimate_plane_joint_dense(const RoadObservations& observations, const PlaneOptions& options,
                                                    Rng& rng) {
  if (const auto usable = check_pixels(observations); !usable) return usable.error();
  const auto first = alignment_start(observations, options, rng);
  if (!first) return first.error();
  const NormalPrior prior(observations, options);
  const PhotometricState nearby = search_nearby(observations, *first, options);
  const auto plane = align_road(observations, nearby, FreeParameters::kPlane, prior, options);
  if (!plane) return plane.error();
  PlaneOptions fine = options;
  fine.dense.levels = 0;
  const auto aligned = align_road(observations, plane->state, FreeParameters::kPlaneAndMotion, prior, fine);
  if (!aligned) return aligned.error();
  if (const auto good = check_alignment(*aligned, *first, options); !good) return good.error();
  if (const auto good = check_motion(aligned->state.motion, first->motion); !good) return good.error();

  PlaneMeasurement measurement;
  measurement.initial_plane = GroundPlane::from_inverse_form(first->m);
  measurement.plane = GroundPlane::from_inverse_form(aligned->state.m);
  measurement.motion = of_unit_length(aligned->state.motion);
  measurement.covariance_of_m =
      alignment_covariance(*aligned, FreeParameters::kPlaneAndMotion, prior, options).block<3, 3>(5, 5);
  if (!measurement.covariance_of_m.allFinite())
    return Error{ErrorCode::kTooFewMatches, "too little texture to tell plane and motion apart"};
  find_points_on_plane(observations, aligned->state.motion, options.max_error_px, measurement);
  return measurement;
}

Result<PlaneMeasurement> estimate_fixed_plane(const RoadObservations& observations, const PlaneOptions& options,
                                              Rng& rng) {
  if (const auto usable = check_pixels(observations); !usable) return usable.error();
  if (observations.expected_normal.isZero())
    return Error{ErrorCode::kBadInput, "the plane is to be given, and no normal is"};
  auto first = alignment_start(observations, options, rng);
  if (!first) return first.error();
  const double unit = first->motion.translation.norm();
  const Eigen::Vector3d& normal = observations.expected_normal;
  first->m = normal * first->m.norm();
  PhotometricState start = search_nearby(observations, *first, options);
  // From here on in heights of the camera.
  start.motion.translation *= start.m.norm();
  start.m = normal;
  const auto aligned = align_road(observations, start, FreeParameters::kMotion, {}, options);
  if (!aligned) return aligned.error();
  if (const auto good = check_motion(aligned->state.motion, first->motion); !good) return good.error();
  PhotometricState in_steps = aligned->state;
  const double steps_per_height = unit / aligned->state.motion.translation.norm();
  in_steps.motion.translation *= steps_per_height;
  in_steps.m /= steps_per_height;
  Aligned judged = *aligned;
  judged.state = in_steps;
  if (const auto good = check_alignment(judged, *first, options); !good) return good.error();

  PlaneMeasurement measurement;
  measurement.initial_plane = GroundPlane::from_inverse_form(first->m);
  measurement.plane = GroundPlane::from_inverse_form(in_steps.m);
  measurement.motion = of_unit_length(in_steps.motion);
  const Eigen::MatrixXd covariance = alignment_covariance(*aligned, FreeParameters::kMotion, {}, options);
  const auto enlarged = [&](double normal_sd_deg) -> Eigen::Matrix3d {
    return covariance_of_fixed(*aligned, covariance, normal_sd_deg * kDegree) / (unit * unit);
  };
  measurement.covariance_of_m = enlarged(0.0);
  if (const auto certain = check_certainty(measurement, options); !certain) return certain.error();
  measurement.covariance_of_m = enlarged(options.fixed_plane.normal_sd_deg);
  find_points_on_plane(observations, in_steps.motion, options.max_error_px, measurement);
  return measurement;
}

}  // namespace groundscale
