#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "groundscale/geometry/essential.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/plane/ground_points_internal.hpp"
#include "groundscale/plane/support_internal.hpp"

namespace groundscale {
namespace {

void add_point(const RigidTransform& motion, const Eigen::Vector3d& ray1, const Eigen::Vector3d& ray2,
               GroundPoint point, std::vector<GroundPoint>& points) {
  const RayDepths depths = triangulate_depths(motion, ray1, ray2);
  if (!std::isfinite(depths.along_ray1) || !(depths.along_ray1 > 0.0) || !(depths.along_ray2 > 0.0)) return;
  point.point_in_cam = depths.along_ray1 * ray1;
  points.push_back(point);
}

/// psi' of the mode as an M-estimate, without the weight: how far one height moves it.
double mode_influence(double height, double mode, double sigma) {
  const double squared = std::pow((height - mode) / sigma, 2);
  return (1.0 - squared) * std::exp(-0.5 * squared);
}

}  // namespace

std::vector<GroundPoint> triangulate_ground_points(const RoadObservations& observations, const PlaneOptions& options,
                                                   GroundPoints which) {
  const RigidTransform& motion = observations.cam_from_reference[1];
  std::vector<GroundPoint> points;
  for (const Transfer& transfer : of_view(consistent_transfers(observations, options), 1)) {
    add_point(motion, transfer.ray1, transfer.ray2, {Eigen::Vector3d::Zero(), transfer.pixel1, transfer.weight},
              points);
  }
  if (which == GroundPoints::kRoad) return points;
  for (const ScenePoint& seen : observations.scene) {
    const auto ray1 = observations.camera->ray(seen.pixel_in_reference);
    const auto ray2 = observations.camera->ray(seen.pixel_in_view1);
    if (ray1 && ray2) add_point(motion, *ray1, *ray2, {Eigen::Vector3d::Zero(), seen.pixel_in_reference, 1.0}, points);
  }
  return points;
}

HeightMode mode_of_heights(std::span<const double> heights, std::span<const double> weights, double sigma) {
  const std::size_t count = heights.size();
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return heights[a] < heights[b]; });
  std::vector<double> scores(count, 0.0);
  constexpr double kReach = 6.0;  // sigmas; beyond it a height is worth less than 2e-8
  for (std::size_t a = 0; a < count; ++a) {
    const std::size_t i = order[a];
    scores[i] += weights[i];
    for (std::size_t b = a + 1; b < count; ++b) {
      const std::size_t j = order[b];
      const double distance = (heights[j] - heights[i]) / sigma;
      if (distance > kReach) break;
      const double closeness = std::exp(-0.5 * distance * distance);
      scores[i] += weights[j] * closeness;
      scores[j] += weights[i] * closeness;
    }
  }
  HeightMode mode;
  mode.height = heights[static_cast<std::size_t>(std::max_element(scores.begin(), scores.end()) - scores.begin())];
  double slope = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double residual = heights[i] - mode.height;
    slope += weights[i] * mode_influence(heights[i], mode.height, sigma);
    squares += std::pow(weights[i] * residual * std::exp(-0.5 * std::pow(residual / sigma, 2)), 2);
    if (std::abs(residual) <= 2.0 * sigma) ++mode.supporters;
  }
  // At a peak the slope is positive; the best of discrete heights may sit beside it.
  mode.variance = slope > 0.0 ? std::min(sigma * sigma, squares / (slope * slope)) : sigma * sigma;
  return mode;
}

Eigen::Matrix3d covariance_of_vote(const std::vector<GroundPoint>& points, const Eigen::Vector3d& normal,
                                   const HeightMode& mode, double sigma, const Eigen::Matrix2d& normal_covariance) {
  Eigen::Vector3d lever = Eigen::Vector3d::Zero();
  double influences = 0.0;
  for (const GroundPoint& point : points) {
    const double influence = point.weight * mode_influence(normal.dot(point.point_in_cam), mode.height, sigma);
    lever += influence * point.point_in_cam;
    influences += influence;
  }
  if (influences > 0.0) lever /= influences;
  Eigen::Matrix<double, 3, 2> by_tangents = Eigen::Matrix<double, 3, 2>::Identity();
  by_tangents.row(2) = lever.transpose() * tangents_of(normal);
  Eigen::Matrix3d covariance = by_tangents * normal_covariance * by_tangents.transpose();
  covariance(2, 2) += mode.variance;
  return covariance;
}

Result<PlaneFit> fit_plane(const std::vector<GroundPoint>& points) {
  double weights = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const GroundPoint& point : points) {
    mean += point.weight * point.point_in_cam;
    weights += point.weight;
  }
  mean /= weights;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const GroundPoint& point : points) {
    const Eigen::Vector3d offset = point.point_in_cam - mean;
    scatter += point.weight * offset * offset.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  constexpr double kLine = 1e-8;  // second over first eigenvalue: a line, or one point
  if (points.size() < 3 || !(solver.eigenvalues()(1) > kLine * solver.eigenvalues()(2))) {
    return Error{ErrorCode::kNotGround, "the triangulated road points lie on one line"};
  }
  PlaneFit fit;
  Eigen::Vector3d normal = solver.eigenvectors().col(0);
  if (normal.dot(mean) < 0.0) normal = -normal;
  fit.plane = {normal, normal.dot(mean)};

  const Eigen::Matrix<double, 3, 2> tangents = tangents_of(normal);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  double squares = 0.0;
  for (const GroundPoint& point : points) {
    const Eigen::Vector2d along = tangents.transpose() * point.point_in_cam;
    const Eigen::Vector3d by_parameters(along.x(), along.y(), -1.0);
    const Eigen::Matrix3d squared = by_parameters * by_parameters.transpose();
    information += point.weight * squared;
    spread += point.weight * point.weight * squared;
    squares += point.weight * std::pow(normal.dot(point.point_in_cam) - fit.plane.height, 2);
  }
  const auto count = static_cast<double>(points.size());
  const double variance = squares / weights * count / std::max(1.0, count - 3.0);
  const Eigen::Matrix3d inverse = information.ldlt().solve(Eigen::Matrix3d::Identity());
  fit.covariance = variance * inverse * spread * inverse;
  return fit;
}

Eigen::Matrix3d covariance_of_m(const GroundPlane& plane, const Eigen::Matrix3d& covariance) {
  Eigen::Matrix3d m_by_parameters;
  m_by_parameters.leftCols<2>() = tangents_of(plane.normal_in_cam) / plane.height;
  m_by_parameters.col(2) = -plane.normal_in_cam / (plane.height * plane.height);
  return m_by_parameters * covariance * m_by_parameters.transpose();
}

double formal_normal_sd_rad(const RoadObservations& observations, const PlaneOptions& options, double rms_px) {
  return observations.normal_prior_factor * options.normal_prior_deg * std::numbers::pi / 180.0 * rms_px /
         options.point_sd_px;
}

}  // namespace groundscale
