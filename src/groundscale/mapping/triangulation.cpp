#include "groundscale/mapping/triangulation.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace groundscale {
namespace {

/// Normal equations of the weighted reprojection errors, and what the errors are.
struct Equations {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double cost = 0.0;
  double squares = 0.0;
};

std::optional<Equations> linearise(std::span<const Sight> sights, const Camera& camera, const Eigen::Vector3d& point,
                                   double loss_px) {
  const double bound2 = loss_px * loss_px;
  Equations equations;
  for (const Sight& sight : sights) {
    Eigen::Matrix<double, 2, 3> by_ray;
    const auto pixel = camera.project(sight.cam_from_world * point, &by_ray);
    if (!pixel) return std::nullopt;
    const Eigen::Vector2d error = *pixel - sight.pixel;
    const Eigen::Matrix<double, 2, 3> by_point = by_ray * sight.cam_from_world.rotation;
    const double squared = error.squaredNorm();
    const double weight = bound2 / (bound2 + squared);
    equations.information.noalias() += weight * by_point.transpose() * by_point;
    equations.gradient.noalias() += weight * by_point.transpose() * error;
    equations.squares += squared;
    equations.cost -= std::log(weight);  // log(1 + (error / loss_px)^2)
  }
  return equations;
}

/// Point nearest to all rays: sum (I - d d^T) (X - c) = 0. Nothing where it lies behind a camera.
std::optional<Eigen::Vector3d> nearest_to_rays(std::span<const Sight> sights) {
  // Seen from the first camera, so that a world far away costs no digits.
  const RigidTransform& first = sights.front().cam_from_world;
  const Eigen::Vector3d origin = -(first.rotation.transpose() * first.translation);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Sight& sight : sights) {
    const RigidTransform& pose = sight.cam_from_world;
    const Eigen::Vector3d direction = pose.rotation.transpose() * sight.ray;
    const Eigen::Vector3d centre = -(pose.rotation.transpose() * pose.translation) - origin;
    information += Eigen::Matrix3d::Identity() - direction * direction.transpose();
    right += centre - direction * direction.dot(centre);
  }
  Eigen::Matrix3d inverse;
  bool invertible = false;
  constexpr double kParallel = 1e-14;  // the determinant is about sights^2 times the squared parallax
  information.computeInverseWithCheck(inverse, invertible, kParallel);
  if (!invertible) return std::nullopt;
  const Eigen::Vector3d point = origin + inverse * right;
  for (const Sight& sight : sights) {
    if (!(sight.ray.dot(sight.cam_from_world * point) > 0.0)) return std::nullopt;
  }
  return point;
}

double parallax_at(const Eigen::Vector3d& point, std::span<const Sight> sights) {
  double chord_squared = 0.0;
  for (std::size_t i = 1; i < sights.size(); ++i) {
    const RigidTransform& pose_i = sights[i].cam_from_world;
    const Eigen::Vector3d to_i = (point + pose_i.rotation.transpose() * pose_i.translation).normalized();
    for (std::size_t k = 0; k < i; ++k) {
      const RigidTransform& pose_k = sights[k].cam_from_world;
      const Eigen::Vector3d to_k = (point + pose_k.rotation.transpose() * pose_k.translation).normalized();
      chord_squared = std::max(chord_squared, (to_i - to_k).squaredNorm());
    }
  }
  return 2.0 * std::asin(std::min(1.0, 0.5 * std::sqrt(chord_squared)));
}

/// Covariance from the sights that agree with the point.
std::optional<Eigen::Matrix3d> covariance_of(std::span<const Sight> sights, const Camera& camera,
                                             const Eigen::Vector3d& point, double max_error_px) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const Sight& sight : sights) {
    Eigen::Matrix<double, 2, 3> by_ray;
    const auto pixel = camera.project(sight.cam_from_world * point, &by_ray);
    if (!pixel || (*pixel - sight.pixel).squaredNorm() > max_error_px * max_error_px) continue;
    const Eigen::Matrix<double, 2, 3> by_point = by_ray * sight.cam_from_world.rotation;
    information.noalias() += by_point.transpose() * by_point;
  }
  const Eigen::Matrix3d inverse = information.inverse();
  if (!inverse.allFinite() || !(inverse.diagonal().minCoeff() > 0.0)) return std::nullopt;
  return inverse;
}

}  // namespace

void visit_fields(TriangulationOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "max_iterations", .unit = "", .help = "steps of Gauss-Newton", .min = 1, .max = 100},
                options.max_iterations);
  visitor.field({.key = "loss_px", .unit = "px", .help = "bound of the Cauchy loss", .min = 0.01, .max = 100},
                options.loss_px);
  visitor.field({.key = "min_parallax_rad",
                 .unit = "rad",
                 .help = "points that are seen under a smaller angle aren't triangulated",
                 .min = 0.0,
                 .max = 1.0},
                options.min_parallax_rad);
}

std::optional<TriangulatedPoint> triangulate(std::span<const Sight> sights, const Camera& camera,
                                             const TriangulationOptions& options) {
  if (sights.size() < 2) return std::nullopt;
  const auto start = nearest_to_rays(sights);
  if (!start) return std::nullopt;
  Eigen::Vector3d point = *start;
  auto equations = linearise(sights, camera, point, options.loss_px);
  if (!equations) return std::nullopt;
  constexpr double kConvergedPx2 = 1e-6;  // squared length of a step, in pixels
  double share = 1.0;                     // of the Gauss-Newton step
  for (int k = 0; k < options.max_iterations; ++k) {
    const Eigen::Vector3d step = -share * (equations->information.inverse() * equations->gradient);
    if (!step.allFinite()) return std::nullopt;
    if (step.dot(equations->information * step) < kConvergedPx2) break;
    const auto next = linearise(sights, camera, point + step, options.loss_px);
    if (!next || next->cost > equations->cost) {
      share *= 0.25;
      continue;
    }
    point += step;
    equations = next;
    share = 1.0;
  }
  TriangulatedPoint result;
  result.point_in_world = point;
  result.rms_px = std::sqrt(equations->squares / static_cast<double>(sights.size()));
  result.parallax_rad = parallax_at(point, sights);
  if (!(result.parallax_rad >= options.min_parallax_rad)) return std::nullopt;
  for (const Sight& sight : sights) {
    if (!(sight.ray.dot(sight.cam_from_world * point) > 0.0)) return std::nullopt;
  }
  const auto covariance = covariance_of(sights, camera, point, 3.0 * options.loss_px);
  if (!covariance) return std::nullopt;
  result.covariance = *covariance;
  return result;
}

}  // namespace groundscale
