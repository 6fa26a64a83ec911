#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "groundscale/core/check.hpp"
#include "groundscale/estimation/robust.hpp"
#include "groundscale/plane/ground_points_internal.hpp"
#include "groundscale/plane/support_internal.hpp"

namespace groundscale {
namespace {

using Triangle = std::array<std::size_t, 3>;

/// Delaunay triangles of the pixels. Of points on the same pixel one stands for all.
std::vector<Triangle> delaunay_triangles(const std::vector<GroundPoint>& points) {
  Eigen::Vector2d low = points.front().pixel_in_reference;
  Eigen::Vector2d high = low;
  for (const GroundPoint& point : points) {
    low = low.cwiseMin(point.pixel_in_reference);
    high = high.cwiseMax(point.pixel_in_reference);
  }
  constexpr int kMargin = 4;
  const cv::Rect bounds(static_cast<int>(low.x()) - kMargin, static_cast<int>(low.y()) - kMargin,
                        static_cast<int>(high.x() - low.x()) + 2 * kMargin + 1,
                        static_cast<int>(high.y() - low.y()) + 2 * kMargin + 1);
  cv::Subdiv2D subdivision(bounds);
  std::map<std::pair<float, float>, std::size_t> point_at;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Point2f pixel(static_cast<float>(points[i].pixel_in_reference.x()),
                            static_cast<float>(points[i].pixel_in_reference.y()));
    if (point_at.emplace(std::pair(pixel.x, pixel.y), i).second) subdivision.insert(pixel);
  }
  std::vector<cv::Vec6f> corners;
  subdivision.getTriangleList(corners);
  std::vector<Triangle> triangles;
  triangles.reserve(corners.size());
  for (const cv::Vec6f& corner : corners) {
    Triangle triangle{};
    bool known = true;
    for (int k = 0; k < 3 && known; ++k) {
      const auto found = point_at.find({corner[2 * k], corner[2 * k + 1]});
      known = found != point_at.end();  // not a corner of the frame around all
      if (known) triangle[static_cast<std::size_t>(k)] = found->second;
    }
    if (known) triangles.push_back(triangle);
  }
  return triangles;
}

/// Whether a point keeps the order of row and depth with its neighbours: what is seen lower is nearer. In place of the
/// row stands n.X / |X|, the sine of the angle below the horizon, in place of depth the distance |X|: on the ground
/// their product is the same everywhere, whatever the camera.
std::vector<bool> keeps_order(const std::vector<GroundPoint>& points, const std::vector<Triangle>& triangles,
                              const Eigen::Vector3d& normal, double max_violations) {
  std::vector<double> distances;
  std::vector<double> below;
  for (const GroundPoint& point : points) {
    distances.push_back(point.point_in_cam.norm());
    below.push_back(normal.dot(point.point_in_cam) / distances.back());
  }
  // An edge inside is counted for both of its triangles, one at the rim once.
  std::vector<int> edges(points.size(), 0);
  std::vector<int> violations(points.size(), 0);
  for (const Triangle& triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = triangle[k];
      const std::size_t j = triangle[(k + 1) % 3];
      const bool violated = (below[i] - below[j]) * (distances[i] - distances[j]) > 0.0;
      for (const std::size_t end : {i, j}) {
        ++edges[end];
        violations[end] += violated ? 1 : 0;
      }
    }
  }
  std::vector<bool> keeps(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    keeps[i] = edges[i] > 0 && violations[i] <= max_violations * edges[i];
  }
  return keeps;
}

/// Points that are vertices of triangles on the ground: all three corners keep the order, the normal fits, and no
/// corner lies higher than the lowest triangles by more than min_height allows.
std::vector<GroundPoint> vertices_on_ground(const std::vector<GroundPoint>& points, const Eigen::Vector3d& normal,
                                            const DelaunayOptions& options) {
  const std::vector<Triangle> triangles = delaunay_triangles(points);
  const std::vector<bool> keeps = keeps_order(points, triangles, normal, options.max_violations);
  const double min_cosine = std::cos(options.max_normal_deg * std::numbers::pi / 180.0);
  std::vector<std::pair<double, Triangle>> flat;  // with the height of the highest corner
  for (const Triangle& triangle : triangles) {
    if (!keeps[triangle[0]] || !keeps[triangle[1]] || !keeps[triangle[2]]) continue;
    const Eigen::Vector3d& a = points[triangle[0]].point_in_cam;
    const Eigen::Vector3d& b = points[triangle[1]].point_in_cam;
    const Eigen::Vector3d& c = points[triangle[2]].point_in_cam;
    const Eigen::Vector3d across = (b - a).cross(c - a);
    if (!(std::abs(across.dot(normal)) >= min_cosine * across.norm()) || across.isZero()) continue;
    flat.emplace_back(std::min({normal.dot(a), normal.dot(b), normal.dot(c)}), triangle);
  }
  if (flat.empty()) return {};
  std::vector<double> heights;
  for (const auto& [height, triangle] : flat) heights.push_back(height);
  constexpr double kLowest = 0.9;  // the very lowest are mismatches
  const double min_height = options.min_height * quantile(heights, kLowest);
  std::vector<bool> chosen(points.size(), false);
  for (const auto& [height, triangle] : flat) {
    if (height < min_height) continue;
    for (const std::size_t corner : triangle) chosen[corner] = true;
  }
  std::vector<GroundPoint> vertices;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (chosen[i]) vertices.push_back(points[i]);
  }
  return vertices;
}

/// Heights of one frame's vertices in units of the height that was predicted for it.
struct FrameVote {
  std::vector<double> heights;
  std::vector<double> weights;
};

class DelaunayMethod {
 public:
  explicit DelaunayMethod(const PlaneOptions& options) : options_(options) {}

  Result<PlaneMeasurement> estimate(const RoadObservations& observations) {
    const DelaunayOptions& own = options_.delaunay;
    if (const auto checked = check_baseline(observations); !checked) return checked.error();
    if (observations.expected_normal.isZero()) {
      return Error{ErrorCode::kBadInput, "delaunay takes the normal from the mounting, and none is given"};
    }
    const Eigen::Vector3d expected = observations.expected_normal.normalized();
    std::vector<GroundPoint> points = triangulate_ground_points(observations, options_, GroundPoints::kAll);
    std::erase_if(points, [&](const GroundPoint& point) { return !(expected.dot(point.point_in_cam) > 0.0); });
    if (static_cast<int>(points.size()) < options_.min_inliers) {
      return Error{ErrorCode::kTooFewMatches,
                   fmt::format("{} points below the horizon could be triangulated, {} needed", points.size(),
                               options_.min_inliers)};
    }
    const std::vector<GroundPoint> vertices = vertices_on_ground(points, expected, own);
    if (static_cast<int>(vertices.size()) < options_.min_inliers) {
      return Error{ErrorCode::kTooFewMatches, fmt::format("{} of {} points are corners of triangles on the ground, {} "
                                                          "needed",
                                                          vertices.size(), points.size(), options_.min_inliers)};
    }
    PlaneFit fit{{expected, 1.0}, {}};
    if (own.normal == DelaunayNormal::kFitted) {
      const auto fitted = fit_ground(vertices, expected);
      if (!fitted) return fitted.error();
      fit = *fitted;
    }
    return measure(observations, vertices, fit);
  }

 private:
  /// Least squares through the vertices, then through those near the height that most of them have.
  Result<PlaneFit> fit_ground(const std::vector<GroundPoint>& vertices, const Eigen::Vector3d& expected) const {
    Eigen::Vector3d normal = expected;
    Result<PlaneFit> fit = PlaneFit{};
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round) {
      const FrameVote vote = vote_of(vertices, normal, 1.0);
      const double sigma = options_.delaunay.kernel * median(vote.heights);
      const HeightMode mode = mode_of_heights(vote.heights, vote.weights, sigma);
      // Before the normal is right, heights of one plane differ.
      const double reach = (round == 0 ? 5.0 : 3.0) * sigma;
      std::vector<GroundPoint> near;
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (std::abs(vote.heights[i] - mode.height) <= reach) near.push_back(vertices[i]);
      }
      fit = fit_plane(near);
      if (!fit) return fit.error();
      normal = fit->plane.normal_in_cam;
    }
    if (normal.dot(expected) < std::cos(options_.delaunay.max_normal_deg * std::numbers::pi / 180.0)) {
      return Error{ErrorCode::kNotGround, fmt::format("the plane of the triangles is more than {:.1f} deg off the "
                                                      "expected normal",
                                                      options_.delaunay.max_normal_deg)};
    }
    return fit;
  }

  static FrameVote vote_of(const std::vector<GroundPoint>& vertices, const Eigen::Vector3d& normal, double unit) {
    FrameVote vote;
    for (const GroundPoint& vertex : vertices) {
      vote.heights.push_back(normal.dot(vertex.point_in_cam) / unit);
      vote.weights.push_back(vertex.weight);
    }
    return vote;
  }

  Result<PlaneMeasurement> measure(const RoadObservations& observations, const std::vector<GroundPoint>& vertices,
                                   const PlaneFit& fit) {
    // Without a prediction nothing ties the units of different frames together.
    const bool alone = !observations.predicted_plane;
    if (alone) window_.clear();
    const double unit = alone ? 1.0 : observations.predicted_plane->height;
    const Eigen::Vector3d& normal = fit.plane.normal_in_cam;
    window_.push_back(vote_of(vertices, normal, unit));
    while (static_cast<int>(window_.size()) > options_.delaunay.window) window_.pop_front();
    FrameVote all;
    for (const FrameVote& vote : window_) {
      all.heights.insert(all.heights.end(), vote.heights.begin(), vote.heights.end());
      all.weights.insert(all.weights.end(), vote.weights.begin(), vote.weights.end());
    }
    if (alone) window_.clear();
    const double sigma = options_.delaunay.kernel * median(all.heights);
    const HeightMode mode = mode_of_heights(all.heights, all.weights, sigma);

    PlaneMeasurement measurement = measurement_of(observations, {normal, mode.height * unit}, options_);
    const HeightMode in_units{mode.height * unit, mode.variance * unit * unit, mode.supporters};
    const Eigen::Matrix3d covariance =
        options_.delaunay.normal == DelaunayNormal::kExpected
            ? covariance_given_normal(observations, options_, measurement.rms_px, in_units)
            : covariance_of_vote(vertices, normal, in_units, sigma * unit, fit.covariance.topLeftCorner<2, 2>());
    measurement.covariance_of_m = covariance_of_m(measurement.plane, covariance);
    return measurement;
  }

  PlaneOptions options_;
  std::deque<FrameVote> window_;
};

}  // namespace

EstimatePlane make_delaunay_method(const PlaneOptions& options) {
  return [method = DelaunayMethod(options)](const RoadObservations& observations, Rng& /*rng*/) mutable {
    GS_CHECK(observations.camera != nullptr && observations.cam_from_reference.size() >= 2,
             "two views and their camera");
    return method.estimate(observations);
  };
}

}  // namespace groundscale
