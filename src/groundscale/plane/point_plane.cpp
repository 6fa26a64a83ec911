#include "groundscale/plane/point_plane.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include "groundscale/core/check.hpp"
#include "groundscale/estimation/robust.hpp"

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMadToSd = 1.4826;

/// Normal equations of (rotation of the normal about two tangents, height, curvature), in metres.
struct Normals {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
  void add(const Eigen::Vector4d& row, double residual, double weight) {
    matrix += weight * row * row.transpose();
    gradient += weight * residual * row;
  }
};

/// Changes of the normal by a radian of pitch and of roll.
struct Tangents {
  Eigen::Vector3d pitch, roll;
};

Tangents tangents_at(const Eigen::Vector3d& normal) {
  // Pitch turns about the camera's x axis, roll about what is across both.
  const Eigen::Vector3d pitch = Eigen::Vector3d::UnitX().cross(normal).normalized();
  return {pitch, normal.cross(pitch)};
}

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

double robust_sd(const PlanePoints& points, const Eigen::Vector3d& normal, double height, double curvature) {
  std::vector<std::pair<double, double>> deviations;
  for (std::size_t i = 0; i < points.points_in_cam.size(); ++i) {
    deviations.emplace_back(std::abs(normal.dot(points.points_in_cam[i]) + 0.5 * curvature * std::pow(points.forward_in_cam.dot(points.points_in_cam[i]), 2) - height), points.weights[i]);
  }
  return kMadToSd * weighted_median(std::move(deviations));
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
  const int count = static_cast<int>(points.points_in_cam.size());
  if (count < options.min_points) {
    return Error{ErrorCode::kTooFewMatches,
                 fmt::format("{} road points on the path, {} are needed", count, options.min_points)};
  }
  const bool expected = !points.expected_normal.isZero();
  Eigen::Vector3d normal = expected ? points.expected_normal : Eigen::Vector3d(Eigen::Vector3d::UnitY());
  std::vector<std::pair<double, double>> heights;
  for (std::size_t i = 0; i < points.points_in_cam.size(); ++i) {
    heights.emplace_back(normal.dot(points.points_in_cam[i]), points.weights[i]);
  }
  double height = weighted_median(std::move(heights));
  const double unit = points.metres_per_unit;

  constexpr int kIterations = 8;
  double sd_m = 0.0;
  double curvature = 0.0;  // per metre
  Eigen::Matrix4d information;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Tangents tangents = tangents_at(normal);
    sd_m = std::max(options.min_point_sd_m, unit * robust_sd(points, normal, height, curvature * unit));
    const CauchyLoss loss{2.0};
    Normals normals;
    for (std::size_t i = 0; i < points.points_in_cam.size(); ++i) {
      const Eigen::Vector3d x = unit * points.points_in_cam[i];
      const double bend = 0.5 * std::pow(points.forward_in_cam.dot(x), 2);
      const double residual = (normal.dot(x) + curvature * bend - unit * height) / sd_m;
      normals.add(Eigen::Vector4d(tangents.pitch.dot(x), tangents.roll.dot(x), -1.0, bend) / sd_m, residual,
                  points.weights[i] * loss.weight(residual));
    }
    for (const Eigen::Vector3d& centre : points.centres_in_cam) {
      const Eigen::Vector3d c = unit * centre;
      const double tie_sd = options.tie_sd_m * std::sqrt(std::max(1e-6, c.norm()));
      const double bend = 0.5 * std::pow(points.forward_in_cam.dot(c), 2);
      normals.add(Eigen::Vector4d(tangents.pitch.dot(c), tangents.roll.dot(c), 0.0, bend) / tie_sd,
                  (normal.dot(c) + curvature * bend) / tie_sd, 1.0);
    }
    if (expected) {
      const Tangents about = tangents_at(points.expected_normal);
      const Eigen::Vector3d off = normal - points.expected_normal;
      const double pitch_sd = options.pitch_prior_deg * kDegree;
      const double roll_sd = options.roll_prior_deg * kDegree;
      normals.add(Eigen::Vector4d(1.0, 0.0, 0.0, 0.0) / pitch_sd, off.dot(about.pitch) / pitch_sd, 1.0);
      normals.add(Eigen::Vector4d(0.0, 1.0, 0.0, 0.0) / roll_sd, off.dot(about.roll) / roll_sd, 1.0);
    }
    constexpr double kFlatSd = 1e-9;
    const double curvature_sd = std::max(kFlatSd, options.curvature_sd_per_m);
    normals.add(Eigen::Vector4d(0.0, 0.0, 0.0, 1.0) / curvature_sd, curvature / curvature_sd, 1.0);
    information = normals.matrix;
    const Eigen::Vector4d step = -information.ldlt().solve(normals.gradient);
    if (!step.allFinite()) return Error{ErrorCode::kNotGround, "the road points don't determine a plane"};
    normal = (normal + step(0) * tangents.pitch + step(1) * tangents.roll).normalized();
    height += step(2) / unit;
    curvature += step(3);
  }
  if (!(height > 0.0)) return Error{ErrorCode::kNotGround, "the road points lie above the camera"};

  PointPlane result;
  result.plane = {normal, height};
  result.curvature_per_m = curvature;
  const Eigen::Matrix4d covariance = information.ldlt().solve(Eigen::Matrix4d::Identity());
  result.log_height_sd = std::sqrt(std::max(0.0, covariance(2, 2))) / (unit * height);
  double squares = 0.0;
  double weights = 0.0;
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Eigen::Vector3d x = unit * points.points_in_cam[k];
    const double residual_m =
        normal.dot(x) + 0.5 * curvature * std::pow(points.forward_in_cam.dot(x), 2) - unit * height;
    if (std::abs(residual_m) > 3.0 * sd_m) continue;
    result.inliers.push_back(i);
    squares += points.weights[k] * residual_m * residual_m;
    weights += points.weights[k];
  }
  result.rms_m = weights > 0.0 ? std::sqrt(squares / weights) : 0.0;
  return result;
}

}  // namespace groundscale
