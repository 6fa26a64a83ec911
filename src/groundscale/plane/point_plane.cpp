#include "groundscale/plane/point_plane.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include "groundscale/core/check.hpp"
#include "groundscale/estimation/robust.hpp"

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// What is estimated, in metres.
struct Road {
  Eigen::Vector3d normal;
  double height_m = 0.0;
  double curvature_per_m = 0.0;

  /// How far a point lies beneath the parallel of the road through the camera, less the height.
  double residual_m(const Eigen::Vector3d& point, double bend) const {
    return normal.dot(point) + curvature_per_m * bend - height_m;
  }
};

/// The caller's points in metres. A point's bend is what the road's curvature is multiplied by there: a^2 / 2.
struct MetricPoints {
  std::vector<Eigen::Vector3d> points, centres;
  std::vector<double> bends, centre_bends;
  const std::vector<double>& weights;
};

MetricPoints in_metres(const PlanePoints& given) {
  MetricPoints metric{{}, {}, {}, {}, given.weights};
  const auto convert = [&given](const std::vector<Eigen::Vector3d>& from, std::vector<Eigen::Vector3d>& points,
                                std::vector<double>& bends) {
    for (const Eigen::Vector3d& point : from) {
      points.emplace_back(given.metres_per_unit * point);
      bends.push_back(0.5 * std::pow(given.forward_in_cam.dot(points.back()), 2));
    }
  };
  convert(given.points_in_cam, metric.points, metric.bends);
  convert(given.centres_in_cam, metric.centres, metric.centre_bends);
  return metric;
}

/// Changes of the normal by a radian of pitch and of roll.
struct Tangents {
  Eigen::Vector3d pitch, roll;
};

Tangents tangents_at(const Eigen::Vector3d& normal) {
  // Pitch turns about the camera's x axis, roll about what is across both.
  const Eigen::Vector3d pitch = Eigen::Vector3d::UnitX().cross(normal).normalized();
  return {pitch, normal.cross(pitch)};
}

/// Normal equations of (pitch, roll, height, curvature).
struct Normals {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();

  /// @param row  Derivative of the residual.
  void add(const Eigen::Vector4d& row, double residual, double sd, double weight = 1.0) {
    const double information = weight / (sd * sd);
    matrix += information * row * row.transpose();
    gradient += information * residual * row;
  }
  /// So little that it moves no result, so much that directions nobody has seen come out as very uncertain.
  Eigen::Matrix4d damped() const {
    Eigen::Matrix4d result = matrix;
    result.diagonal() += 1e-9 * matrix.diagonal() + Eigen::Vector4d::Constant(1e-6);
    return result;
  }
  Eigen::Vector4d step() const { return -damped().ldlt().solve(gradient); }
  Eigen::Matrix4d covariance() const { return damped().ldlt().solve(Eigen::Matrix4d::Identity()); }
};

/// Value that half of the weights lie below.
double weighted_median(std::vector<std::pair<double, double>> values_and_weights) {
  std::sort(values_and_weights.begin(), values_and_weights.end());
  double total = 0.0;
  for (const auto& entry : values_and_weights) total += entry.second;
  double sum = 0.0;
  for (const auto& [value, weight] : values_and_weights) {
    sum += weight;
    if (sum >= 0.5 * total) return value;
  }
  return values_and_weights.back().first;
}

double median_height_m(const MetricPoints& metric, const Eigen::Vector3d& normal) {
  std::vector<std::pair<double, double>> heights;
  for (std::size_t i = 0; i < metric.points.size(); ++i) {
    heights.emplace_back(normal.dot(metric.points[i]), metric.weights[i]);
  }
  return weighted_median(std::move(heights));
}

double robust_sd_m(const MetricPoints& metric, const Road& road) {
  constexpr double kMadToSd = 1.4826;
  std::vector<std::pair<double, double>> deviations;
  for (std::size_t i = 0; i < metric.points.size(); ++i) {
    deviations.emplace_back(std::abs(road.residual_m(metric.points[i], metric.bends[i])), metric.weights[i]);
  }
  return kMadToSd * weighted_median(std::move(deviations));
}

void add_points(const MetricPoints& metric, const Road& road, double sd_m, Normals& normals) {
  const CauchyLoss loss{2.0};  // in sd
  const Tangents tangents = tangents_at(road.normal);
  for (std::size_t i = 0; i < metric.points.size(); ++i) {
    const Eigen::Vector3d& x = metric.points[i];
    const double residual_m = road.residual_m(x, metric.bends[i]);
    normals.add({tangents.pitch.dot(x), tangents.roll.dot(x), -1.0, metric.bends[i]}, residual_m, sd_m,
                metric.weights[i] * loss.weight(residual_m / sd_m));
  }
}

void add_ties(const MetricPoints& metric, const Road& road, double tie_sd_m, Normals& normals) {
  const Tangents tangents = tangents_at(road.normal);
  for (std::size_t j = 0; j < metric.centres.size(); ++j) {
    const Eigen::Vector3d& c = metric.centres[j];
    const double sd_m = tie_sd_m * std::sqrt(std::max(1e-6, c.norm()));
    normals.add({tangents.pitch.dot(c), tangents.roll.dot(c), 0.0, metric.centre_bends[j]},
                road.normal.dot(c) + road.curvature_per_m * metric.centre_bends[j], sd_m);
  }
}

void add_priors(const Eigen::Vector3d& expected_normal, const Road& road, const PointPlaneOptions& options,
                Normals& normals) {
  constexpr double kFlatSd = 1e-9;
  normals.add(Eigen::Vector4d::Unit(3), road.curvature_per_m, std::max(kFlatSd, options.curvature_sd_per_m));
  if (expected_normal.isZero()) return;
  const Tangents tangents = tangents_at(expected_normal);
  const Eigen::Vector3d off = road.normal - expected_normal;
  normals.add(Eigen::Vector4d::Unit(0), off.dot(tangents.pitch), options.pitch_prior_deg * kDegree);
  normals.add(Eigen::Vector4d::Unit(1), off.dot(tangents.roll), options.roll_prior_deg * kDegree);
}

void move(const Eigen::Vector4d& step, Road& road) {
  const Tangents tangents = tangents_at(road.normal);
  road.normal = (road.normal + step(0) * tangents.pitch + step(1) * tangents.roll).normalized();
  road.height_m += step(2);
  road.curvature_per_m += step(3);
}

void take_inliers(const MetricPoints& metric, const Road& road, double sd_m, PointPlane& result) {
  double squares = 0.0;
  double weights = 0.0;
  for (std::size_t i = 0; i < metric.points.size(); ++i) {
    const double residual_m = road.residual_m(metric.points[i], metric.bends[i]);
    if (std::abs(residual_m) > 3.0 * sd_m) continue;
    result.inliers.push_back(static_cast<int>(i));
    squares += metric.weights[i] * residual_m * residual_m;
    weights += metric.weights[i];
  }
  result.rms_m = weights > 0.0 ? std::sqrt(squares / weights) : 0.0;
}

}  // namespace

void visit_fields(PointPlaneOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "min_point_sd_m",
                 .unit = "m",
                 .help = "roughness of a road: no point says more about the plane",
                 .min = 0.0005,
                 .max = 0.2},
                options.min_point_sd_m);
  visitor.field({.key = "tie_sd_m",
                 .unit = "m",
                 .help = "sd of the camera's height over its road, for each root metre driven",
                 .min = 0.0005,
                 .max = 1},
                options.tie_sd_m);
  visitor.field({.key = "pitch_prior_deg",
                 .unit = "deg",
                 .help = "sd of the road's pitch about its running mean",
                 .min = 0.01,
                 .max = 90},
                options.pitch_prior_deg);
  visitor.field({.key = "roll_prior_deg",
                 .unit = "deg",
                 .help = "sd of the road's roll about its running mean",
                 .min = 0.01,
                 .max = 90},
                options.roll_prior_deg);
  visitor.field({.key = "curvature_sd_per_m",
                 .unit = "1/m",
                 .help = "sd of the road's curvature along the path, up or down; 0: a plane",
                 .min = 0,
                 .max = 1},
                options.curvature_sd_per_m);
  visitor.field(
      {.key = "min_points", .unit = "", .help = "road points that a measurement takes", .min = 3, .max = 10000},
      options.min_points);
}

Result<PointPlane> fit_point_plane(const PlanePoints& points, const PointPlaneOptions& options) {
  GS_CHECK(points.weights.size() == points.points_in_cam.size(), "a weight for each point");
  const std::size_t count = points.points_in_cam.size();
  if (count < static_cast<std::size_t>(std::max(1, options.min_points))) {
    return Error{ErrorCode::kTooFewMatches,
                 fmt::format("{} road points on the path, {} are needed", count, options.min_points)};
  }
  const MetricPoints metric = in_metres(points);
  Road road{points.expected_normal.isZero() ? Eigen::Vector3d(Eigen::Vector3d::UnitY()) : points.expected_normal};
  road.height_m = median_height_m(metric, road.normal);

  constexpr int kIterations = 8;
  double sd_m = 0.0;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    sd_m = std::max(options.min_point_sd_m, robust_sd_m(metric, road));
    Normals normals;
    add_points(metric, road, sd_m, normals);
    add_ties(metric, road, options.tie_sd_m, normals);
    add_priors(points.expected_normal, road, options, normals);
    move(normals.step(), road);
    if (iteration + 1 == kIterations) covariance = normals.covariance();
  }
  constexpr double kMaxAngleSd = 0.3;
  if (!(std::max(covariance(0, 0), covariance(1, 1)) < kMaxAngleSd * kMaxAngleSd) || !road.normal.allFinite()) {
    return Error{ErrorCode::kNotGround, "the road points don't determine a plane"};
  }
  if (!(road.height_m > 0.0)) return Error{ErrorCode::kNotGround, "the road points lie above the camera"};

  PointPlane result;
  result.plane = {road.normal, road.height_m / points.metres_per_unit};
  result.curvature_per_m = road.curvature_per_m;
  result.log_height_sd = std::sqrt(covariance(2, 2)) / road.height_m;
  take_inliers(metric, road, sd_m, result);
  return result;
}

}  // namespace groundscale
