#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

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

/// Heights that share a narrow bin.
struct HeightBin {
  long index = 0;
  std::size_t begin = 0, end = 0;  ///< In the sorted heights.
  double weight = 0.0;
  double bound = 0.0;  ///< No height of the bin has a better score.
};

constexpr double kReach = 6.0;  // sigmas; beyond it a height is worth less than 2e-8
constexpr int kBinsPerSigma = 32;

/// Bins that aren't empty, best bound first. Bins a and b are at least |a - b| - 1 widths apart.
std::vector<HeightBin> bounded_bins(const std::vector<std::pair<double, double>>& sorted, double sigma) {
  std::vector<HeightBin> bins;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const long index = std::lround(std::floor((sorted[i].first - sorted.front().first) / sigma * kBinsPerSigma));
    if (bins.empty() || bins.back().index != index) bins.push_back({index, i, i, 0.0, 0.0});
    bins.back().end = i + 1;
    bins.back().weight += sorted[i].second;
  }
  constexpr int kBinsInReach = static_cast<int>(kReach) * kBinsPerSigma + 1;
  std::array<double, kBinsInReach + 1> closeness{};
  for (int k = 0; k <= kBinsInReach; ++k) {
    closeness[static_cast<std::size_t>(k)] = std::exp(-0.5 * std::pow(std::max(0.0, k - 1.0) / kBinsPerSigma, 2));
  }
  for (std::size_t a = 0; a < bins.size(); ++a) {
    bins[a].bound += bins[a].weight;
    for (std::size_t b = a + 1; b < bins.size() && bins[b].index - bins[a].index <= kBinsInReach; ++b) {
      const double near = closeness[static_cast<std::size_t>(bins[b].index - bins[a].index)];
      bins[a].bound += bins[b].weight * near;
      bins[b].bound += bins[a].weight * near;
    }
  }
  std::sort(bins.begin(), bins.end(), [](const HeightBin& a, const HeightBin& b) {
    return a.bound != b.bound ? a.bound > b.bound : a.index < b.index;
  });
  return bins;
}

/// The height with the best score. Only those are scored whose bin may hold it.
double best_height(std::span<const double> heights, std::span<const double> weights, double sigma) {
  std::vector<std::pair<double, double>> sorted;
  for (std::size_t i = 0; i < heights.size(); ++i) sorted.emplace_back(heights[i], weights[i]);
  std::sort(sorted.begin(), sorted.end());
  double best = sorted.front().first;
  double best_score = 0.0;
  for (const HeightBin& bin : bounded_bins(sorted, sigma)) {
    if (bin.bound < best_score) break;
    for (std::size_t i = bin.begin; i < bin.end; ++i) {
      const double height = sorted[i].first;
      double score = 0.0;
      for (auto other = std::lower_bound(sorted.begin(), sorted.end(), std::pair(height - kReach * sigma, 0.0));
           other != sorted.end() && other->first <= height + kReach * sigma; ++other) {
        score += other->second * std::exp(-0.5 * std::pow((other->first - height) / sigma, 2));
      }
      if (score <= best_score) continue;
      best = height;
      best_score = score;
    }
  }
  return best;
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
  HeightMode mode;
  mode.height = best_height(heights, weights, sigma);
  double slope = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < heights.size(); ++i) {
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

Eigen::Matrix3d covariance_given_normal(const RoadObservations& observations, const PlaneOptions& options,
                                        double rms_px, const HeightMode& mode) {
  const double normal_sd_rad = observations.normal_prior_factor * options.normal_prior_deg * std::numbers::pi / 180.0 *
                               rms_px / options.point_sd_px;
  const double normal_variance = normal_sd_rad * normal_sd_rad;
  return Eigen::Vector3d(normal_variance, normal_variance, mode.variance).asDiagonal();
}

}  // namespace groundscale
