#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <fmt/format.h>

#include "groundscale/core/check.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/plane/ground_points_internal.hpp"
#include "groundscale/plane/support_internal.hpp"

namespace groundscale {
namespace {

struct PlaneProblem {
  using Model = GroundPlane;
  static constexpr int kSampleSize = 3;

  const std::vector<GroundPoint>& points;
  Eigen::Vector3d expected_normal;  ///< Zero: any.
  double min_cosine;                ///< To the expected normal.
  double max_distance;              ///< Over the plane's height.

  int count() const { return static_cast<int>(points.size()); }
  double max_error() const { return max_distance; }
  std::vector<GroundPlane> fit(std::span<const int> sample) const {
    Eigen::Matrix3d rows;
    for (int k = 0; k < 3; ++k) {
      const auto chosen = static_cast<std::size_t>(sample[static_cast<std::size_t>(k)]);
      rows.row(k) = points[chosen].point_in_cam.transpose();
    }
    // X.m = 1 for each of the three.
    const Eigen::Vector3d m = rows.partialPivLu().solve(Eigen::Vector3d::Ones());
    if (!m.allFinite() || !(m.norm() > 0.0)) return {};
    const GroundPlane plane = GroundPlane::from_inverse_form(m);
    if (!expected_normal.isZero() && plane.normal_in_cam.dot(expected_normal) < min_cosine) return {};
    return {plane};
  }
  double error(const GroundPlane& plane, int item) const {
    return plane.normal_in_cam.dot(points[static_cast<std::size_t>(item)].point_in_cam) / plane.height - 1.0;
  }
};

/// The fit with the direction of motion c, which runs along a straight road, as one more observation: c.n = 0 with an
/// sd. Both are weighted by their variances; one Gauss-Newton step from the fit, whose equations are linear.
PlaneFit fuse_direction(const PlaneFit& fit, const Eigen::Vector3d& direction, double sd_rad) {
  const Eigen::Matrix<double, 3, 2> tangents = tangents_of(fit.plane.normal_in_cam);
  Eigen::Vector3d by_parameters = Eigen::Vector3d::Zero();  // two tangents of n, h
  by_parameters.head<2>() = tangents.transpose() * direction;
  const double residual = direction.dot(fit.plane.normal_in_cam);
  const Eigen::Vector3d gain =
      fit.covariance * by_parameters / (by_parameters.dot(fit.covariance * by_parameters) + sd_rad * sd_rad);
  const Eigen::Vector3d step = -gain * residual;
  PlaneFit fused;
  fused.plane.normal_in_cam = (fit.plane.normal_in_cam + tangents * step.head<2>()).normalized();
  fused.plane.height = fit.plane.height + step.z();
  fused.covariance = fit.covariance - gain * (by_parameters.transpose() * fit.covariance);
  return fused;
}

}  // namespace

Result<PlaneMeasurement> estimate_plane_triangulation_ransac(const RoadObservations& observations,
                                                             const PlaneOptions& options, Rng& rng) {
  GS_CHECK(observations.camera != nullptr && observations.cam_from_reference.size() >= 2, "two views and their camera");
  if (const auto checked = check_baseline(observations); !checked) return checked.error();
  constexpr double kDegree = std::numbers::pi / 180.0;
  const TriangulationRansacOptions& own = options.triangulation_ransac;
  const std::vector<GroundPoint> points = triangulate_ground_points(observations, options, own.points);
  if (static_cast<int>(points.size()) < options.min_inliers) {
    return Error{ErrorCode::kTooFewMatches,
                 fmt::format("{} points could be triangulated, {} needed", points.size(), options.min_inliers)};
  }
  const PlaneProblem problem{points, own.max_normal_deg > 0.0 ? observations.expected_normal : Eigen::Vector3d::Zero(),
                             std::cos(own.max_normal_deg * kDegree), own.max_distance};
  const auto found = ransac(problem, options.ransac, rng);
  if (!found) return Error{ErrorCode::kNotGround, "no plane near the expected one lies in the triangulated points"};

  GroundPlane initial;
  PlaneFit fit{found->model, {}};
  // The plane through all inliers lets in others than that through three.
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<GroundPoint> inliers;
    for (const int i : inliers_of(problem, fit.plane)) inliers.push_back(points[static_cast<std::size_t>(i)]);
    if (static_cast<int>(inliers.size()) < options.min_inliers) {
      return Error{ErrorCode::kTooFewMatches, fmt::format("{} of {} triangulated points lie on one plane, {} needed",
                                                          inliers.size(), points.size(), options.min_inliers)};
    }
    const auto fitted = fit_plane(inliers);
    if (!fitted) return fitted.error();
    fit = *fitted;
    if (round == 0) initial = fit.plane;
  }
  if (own.vanishing_point_sd_deg > 0.0) {
    const RigidTransform& motion = observations.cam_from_reference[1];
    const Eigen::Vector3d direction = -(motion.rotation.transpose() * motion.translation).normalized();
    fit = fuse_direction(fit, direction, own.vanishing_point_sd_deg * kDegree);
  }
  PlaneMeasurement measurement = measurement_of(observations, fit.plane, options);
  measurement.initial_plane = initial;
  measurement.covariance_of_m = covariance_of_m(fit.plane, fit.covariance);
  return measurement;
}

}  // namespace groundscale
