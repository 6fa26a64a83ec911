#include "groundscale/road/region.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "groundscale/core/check.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/tracking/opencv_internal.hpp"

namespace groundscale {
namespace {

constexpr int kShift = 4;  // fillPoly's fractional bits

cv::Point fixed_point(const Eigen::Vector2d& pixel) {
  constexpr double kOne = 1 << kShift;
  constexpr double kBound = 30000.0;  // far outside of any image, well within an int
  return {static_cast<int>(std::lround(std::clamp(pixel.x(), -kBound, kBound) * kOne)),
          static_cast<int>(std::lround(std::clamp(pixel.y(), -kBound, kBound) * kOne))};
}

Image filled(const std::vector<std::vector<cv::Point>>& polygons, int width, int height) {
  Image mask(width, height);
  cv::Mat view = view_of(mask);
  for (const auto& polygon : polygons) cv::fillPoly(view, std::vector{polygon}, cv::Scalar(255), cv::LINE_8, kShift);
  return cv::countNonZero(view) > 0 ? mask : Image();
}

Image polygon_mask(const std::vector<double>& polygon_px, int width, int height) {
  std::vector<cv::Point> polygon;
  for (std::size_t i = 0; i + 1 < polygon_px.size(); i += 2) {
    polygon.push_back(fixed_point({polygon_px[i], polygon_px[i + 1]}));
  }
  return filled({polygon}, width, height);
}

}  // namespace

void visit_fields(StripOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "near_m", .unit = "m", .help = "where the strip begins, along the path", .min = 0.5, .max = 50},
                options.near_m);
  visitor.field({.key = "far_m", .unit = "m", .help = "where the strip ends, along the path", .min = 1, .max = 100},
                options.far_m);
  visitor.field(
      {.key = "half_width_m", .unit = "m", .help = "of the strip, to each side of the path", .min = 0.3, .max = 10},
      options.half_width_m);
  visitor.field(
      {.key = "turn_far_m", .unit = "m", .help = "where the strip ends in a tight turn", .min = 1, .max = 100},
      options.turn_far_m);
}

void visit_fields(RegionOptions& options, FieldVisitor& visitor) {
  visit_fields(static_cast<StripOptions&>(options), visitor);
  visitor.field({.key = "max_turn_deg",
                 .unit = "deg",
                 .help = "the strip ends where the path has turned by so much",
                 .min = 5,
                 .max = 180},
                options.max_turn_deg);
  visitor.field({.key = "weight_sd_m",
                 .unit = "m",
                 .help = "road points count less the farther they lie from the path (roads fall off to their sides); "
                         "with polygon_px all count the same",
                 .min = 0.1,
                 .max = 100},
                options.weight_sd_m);
  visitor.field({.key = "polygon_px",
                 .unit = "px",
                 .help = "x, y, x, y, ... of a fixed region of the image, instead of the strip, in both modes",
                 .min = -100000,
                 .max = 100000},
                options.polygon_px);
}

double DrivenPath::sd_m(double along_m) const {
  return steady_m > 0.0 ? std::abs(curvature_per_m) * std::pow(std::max(0.0, along_m), 3) / (6.0 * steady_m) : 0.0;
}

DrivenPath path_of_motion(const RigidTransform& metric_cam2_from_cam1, const Eigen::Vector3d& normal_in_cam,
                          const Eigen::Vector3d& mounting_forward_in_cam, double max_turn_deg) {
  const double max_turn_rad = max_turn_deg * std::numbers::pi / 180.0;
  const Eigen::Vector3d on_road =
      Eigen::Vector3d(mounting_forward_in_cam - normal_in_cam * normal_in_cam.dot(mounting_forward_in_cam))
          .normalized();
  const Eigen::Vector3d camera2_in_cam1 = metric_cam2_from_cam1.inverse().translation;
  const Eigen::Vector3d chord = camera2_in_cam1 - normal_in_cam * normal_in_cam.dot(camera2_in_cam1);
  const double length = chord.norm();
  constexpr double kMinStepM = 0.05;  // below, the direction is the noise's
  if (length < kMinStepM) return {on_road, 0.0, max_turn_rad};

  // Turn to the right is a positive rotation of the vehicle about the downward normal; the camera's is its inverse's.
  const double turn = normal_in_cam.dot(log_so3(metric_cam2_from_cam1.rotation.transpose()));
  const double sense = chord.dot(on_road) < 0.0 ? -1.0 : 1.0;
  // The tangent at the chord's start lies half of the turn before the chord.
  const Eigen::Vector3d tangent = exp_so3(-0.5 * turn * normal_in_cam) * Eigen::Vector3d(sense * chord / length);
  // A chord that points far from where the camera looks along the road isn't the vehicle's path.
  constexpr double kMaxHeading = 0.5;
  if (tangent.cross(on_road).norm() > std::sin(kMaxHeading)) return {on_road, 0.0, max_turn_rad};
  return {tangent, sense * turn / length, max_turn_rad};
}

Eigen::Vector3d point_on_path(const DrivenPath& path, const GroundPlane& metric_road, double along_m, double aside_m) {
  const Eigen::Vector3d right = metric_road.normal_in_cam.cross(path.forward_in_cam);
  const double curvature = path.curvature_per_m;
  const double arc_m = curvature == 0.0 ? along_m : std::min(along_m, path.max_turn_rad / std::abs(curvature));
  const double angle = arc_m * curvature;
  // Arc of radius 1 / curvature; series where it is nearly straight.
  const bool straight = std::abs(angle) < 1e-6;
  const double beyond_m = along_m - arc_m;
  const double ahead = (straight ? arc_m : std::sin(angle) / curvature) + beyond_m * std::cos(angle);
  const double drift =
      (straight ? 0.5 * arc_m * angle : (1.0 - std::cos(angle)) / curvature) + beyond_m * std::sin(angle);
  return metric_road.normal_in_cam * metric_road.height + path.forward_in_cam * (ahead - aside_m * std::sin(angle)) +
         right * (drift + aside_m * std::cos(angle));
}

double offset_from_path(const DrivenPath& path, const GroundPlane& metric_road, const Eigen::Vector3d& ray) {
  const Eigen::Vector3d point = ray * (metric_road.height / metric_road.normal_in_cam.dot(ray));
  const double ahead = point.dot(path.forward_in_cam);
  const double aside = point.dot(metric_road.normal_in_cam.cross(path.forward_in_cam));
  const double curvature = path.curvature_per_m;
  constexpr double kMinCurvature = 1e-6;
  if (std::abs(curvature) < kMinCurvature) return aside;
  // Beyond the end of the arc: from the straight line that goes on there.
  const double angle = std::copysign(path.max_turn_rad, curvature);
  const double end_ahead = std::sin(angle) / curvature;
  const double end_aside = (1.0 - std::cos(angle)) / curvature;
  const double beyond = (ahead - end_ahead) * std::cos(angle) + (aside - end_aside) * std::sin(angle);
  if (beyond > 0.0) return (aside - end_aside) * std::cos(angle) - (ahead - end_ahead) * std::sin(angle);
  const double radius = 1.0 / curvature;
  return radius - std::copysign(std::hypot(ahead, radius - aside), radius);
}

Image region_mask(const DrivenPath& path, const GroundPlane& metric_road, const Camera& camera,
                  const RegionOptions& options) {
  if (!options.polygon_px.empty()) return polygon_mask(options.polygon_px, camera.width(), camera.height());
  // In a tight turn the road beyond the arc is somebody else's.
  double far_m = options.far_m;
  if (path.curvature_per_m != 0.0) {
    far_m = std::min(far_m, std::max(options.turn_far_m, path.max_turn_rad / std::abs(path.curvature_per_m)));
  }

  // Quads of half a metre, so that an edge that leaves the camera's field costs no more than its own piece.
  constexpr double kPieceM = 0.5;
  std::vector<std::vector<cv::Point>> quads;
  std::optional<Eigen::Vector2d> last_left;
  std::optional<Eigen::Vector2d> last_right;
  for (double along = options.near_m; along < far_m + 0.5 * kPieceM; along += kPieceM) {
    const double aside_m = options.half_width_m + std::min(options.half_width_m, path.sd_m(along));
    const auto left = camera.project(point_on_path(path, metric_road, along, -aside_m));
    const auto right = camera.project(point_on_path(path, metric_road, along, aside_m));
    if (left && right && last_left && last_right) {
      quads.push_back({fixed_point(*last_left), fixed_point(*left), fixed_point(*right), fixed_point(*last_right)});
    }
    last_left = left;
    last_right = right;
  }
  return filled(quads, camera.width(), camera.height());
}

Image restrict_region(const Image& region, const Image& allowed) {
  return region.empty() ? region : intersect_masks(region, allowed);
}

Image intersect_masks(const Image& a, const Image& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  GS_CHECK(a.width() == b.width() && a.height() == b.height(), "masks of one size");
  Image both(a.width(), a.height());
  cv::Mat view = view_of(both);
  cv::bitwise_and(view_of(a), view_of(b), view);
  return both;
}

int mask_area(const Image& mask) { return mask.empty() ? 0 : cv::countNonZero(view_of(mask)); }

}  // namespace groundscale
