#include <cmath>

#include <fmt/format.h>

#include "groundscale/core/check.hpp"
#include "groundscale/estimation/robust.hpp"
#include "groundscale/plane/ground_points_internal.hpp"
#include "groundscale/plane/support_internal.hpp"

namespace groundscale {
namespace {

struct Candidates {
  std::vector<GroundPoint> points;
  std::vector<double> heights;
  std::vector<double> weights;
  double median_distance = 0.0;
};

/// Points nearer than the median distance whose height may be the ground's.
Candidates candidates_of(const std::vector<GroundPoint>& points, const Eigen::Vector3d& normal, double min_height) {
  std::vector<double> distances;
  distances.reserve(points.size());
  for (const GroundPoint& point : points) distances.push_back(point.point_in_cam.lpNorm<1>());
  Candidates candidates;
  candidates.median_distance = median(distances);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double height = normal.dot(points[i].point_in_cam);
    if (distances[i] > candidates.median_distance || height <= min_height * candidates.median_distance) continue;
    candidates.points.push_back(points[i]);
    candidates.heights.push_back(height);
    candidates.weights.push_back(points[i].weight);
  }
  return candidates;
}

double kernel_sigma(const RoadObservations& observations, const TriangulationPlaneOptions& options,
                    double median_distance) {
  switch (options.kernel) {
    case HeightKernel::kMedianDistance:
      return median_distance / options.mu;
    case HeightKernel::kBaseline:
      return observations.cam_from_reference[1].translation.norm() / std::sqrt(2.0 * options.mu);
    case HeightKernel::kCameraHeight:
      return observations.predicted_plane->height / std::sqrt(2.0 * options.mu);
  }
  return median_distance / options.mu;
}

}  // namespace

Result<PlaneMeasurement> estimate_plane_triangulation(const RoadObservations& observations, const PlaneOptions& options,
                                                      Rng& /*rng*/) {
  GS_CHECK(observations.camera != nullptr && observations.cam_from_reference.size() >= 2, "two views and their camera");
  if (const auto checked = check_baseline(observations); !checked) return checked.error();
  if (observations.expected_normal.isZero()) {
    return Error{ErrorCode::kBadInput, "triangulation takes the normal from the mounting, and none is given"};
  }
  if (options.triangulation.kernel == HeightKernel::kCameraHeight && !observations.predicted_plane) {
    return Error{ErrorCode::kBadInput, "triangulation with kernel: camera_height needs a predicted plane"};
  }
  const Eigen::Vector3d normal = observations.expected_normal.normalized();
  const std::vector<GroundPoint> points =
      triangulate_ground_points(observations, options, options.triangulation.points);
  if (static_cast<int>(points.size()) < options.min_inliers) {
    return Error{ErrorCode::kTooFewMatches,
                 fmt::format("{} points could be triangulated, {} needed", points.size(), options.min_inliers)};
  }
  const Candidates candidates = candidates_of(points, normal, options.triangulation.min_height);
  if (candidates.heights.empty()) {
    return Error{ErrorCode::kNotGround, "none of the nearer half of the triangulated points lies below the camera"};
  }
  const double sigma = kernel_sigma(observations, options.triangulation, candidates.median_distance);
  const HeightMode mode = mode_of_heights(candidates.heights, candidates.weights, sigma);
  // Half of the points were left out as too far away.
  if (2 * mode.supporters < options.min_inliers) {
    return Error{ErrorCode::kTooFewMatches,
                 fmt::format("{} triangulated points have the height of the ground, {} needed", mode.supporters,
                             (options.min_inliers + 1) / 2)};
  }
  PlaneMeasurement measurement = measurement_of(observations, {normal, mode.height}, options);
  measurement.covariance_of_m =
      covariance_of_m(measurement.plane, covariance_given_normal(observations, options, measurement.rms_px, mode));
  return measurement;
}

}  // namespace groundscale
