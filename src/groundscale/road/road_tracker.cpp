#include "groundscale/road/road_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "groundscale/geometry/so3.hpp"
#include "groundscale/road/crop_internal.hpp"
#include "groundscale/road/warp_field_internal.hpp"
#include "groundscale/tracking/opencv_internal.hpp"

namespace groundscale {
namespace {

/// Smallest rectangle about the points with a margin that a window needs.
cv::Rect area_of(const std::vector<TrackPoint>& points, const Image& image, int margin) {
  Eigen::Vector2d low = points.front().pixel;
  Eigen::Vector2d high = low;
  for (const TrackPoint& point : points) {
    low = low.cwiseMin(point.pixel);
    high = high.cwiseMax(point.pixel);
  }
  const cv::Point corner(static_cast<int>(std::floor(low.x())) - margin,
                         static_cast<int>(std::floor(low.y())) - margin);
  const cv::Point end(static_cast<int>(std::ceil(high.x())) + margin + 1,
                      static_cast<int>(std::ceil(high.y())) + margin + 1);
  return cv::Rect(corner, end) & cv::Rect(0, 0, image.width(), image.height());
}

/// Correlation of intensities over sampled pixels; -1 where too few of them are in view.
class RegionCorrelation {
 public:
  RegionCorrelation(const Image& first, const Image& second, const Image& mask, const Camera& camera)
      : camera_(camera) {
    // Smoothed, so that a search in steps of a few per cent can't miss.
    cv::Mat smooth;
    cv::boxFilter(view_of(first), smooth, -1, {kSmoothPx, kSmoothPx});
    cv::boxFilter(view_of(second), second_, -1, {kSmoothPx, kSmoothPx});
    const cv::Mat allowed = view_of(mask);
    for (int y = 0; y < allowed.rows; y += kStridePx) {
      for (int x = 0; x < allowed.cols; x += kStridePx) {
        if (allowed.at<std::uint8_t>(y, x) == 0) continue;
        const auto ray = camera.ray({x, y});
        if (ray) samples_.push_back({*ray, static_cast<double>(smooth.at<std::uint8_t>(y, x))});
      }
    }
  }

  double of(const Eigen::Matrix3d& homography) const {
    double n = 0.0;
    double a = 0.0;
    double b = 0.0;
    double aa = 0.0;
    double bb = 0.0;
    double ab = 0.0;
    for (const Sample& sample : samples_) {
      const auto pixel = camera_.project(homography * sample.ray);
      if (!pixel) continue;
      const int x = static_cast<int>(std::lround(pixel->x()));
      const int y = static_cast<int>(std::lround(pixel->y()));
      if (x < 0 || y < 0 || x >= second_.cols || y >= second_.rows) continue;
      const double value = second_.at<std::uint8_t>(y, x);
      n += 1.0;
      a += sample.value;
      b += value;
      aa += sample.value * sample.value;
      bb += value * value;
      ab += sample.value * value;
    }
    constexpr double kMinShare = 0.4;
    if (n < kMinShare * static_cast<double>(samples_.size()) || n < kMinSamples) return -1.0;
    const double spread = (aa - a * a / n) * (bb - b * b / n);
    return spread > 0.0 ? (ab - a * b / n) / std::sqrt(spread) : -1.0;
  }

 private:
  struct Sample {
    Eigen::Vector3d ray;
    double value;
  };
  static constexpr int kSmoothPx = 5;
  static constexpr int kStridePx = 5;
  static constexpr double kMinSamples = 50;
  cv::Mat second_;
  const Camera& camera_;
  std::vector<Sample> samples_;
};

}  // namespace

void visit_fields(RoadTrackingOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "front_end", .unit = "", .help = "how points of the road are found and followed"},
                options.front_end);
  visitor.field({.key = "max_points", .unit = "", .help = "road points a frame", .min = 30, .max = 20000},
                options.max_points);
  visitor.field({.key = "rough_points",
                 .unit = "",
                 .help = "road points followed through the predicted warp, to find a better one",
                 .min = 30,
                 .max = 20000},
                options.rough_points);
  visitor.field({.key = "fine_levels",
                 .unit = "",
                 .help = "halvings of the image when all road points are followed through the better warp",
                 .min = 0,
                 .max = 5},
                options.fine_levels);
  visitor.field({.key = "cell_px",
                 .unit = "px",
                 .help = "one new road point at most in each cell of this size",
                 .min = 3,
                 .max = 100},
                options.detect.cell_px);
  visitor.field({.key = "min_gradient",
                 .unit = "grey levels/px",
                 .help = "weakest texture that a road point may have",
                 .min = 0.1,
                 .max = 100},
                options.detect.min_gradient);
  visitor.field({.key = "window_px", .unit = "px", .help = "side of the patch that is followed", .min = 5, .max = 61},
                options.klt.window_px);
  visitor.field({.key = "max_round_trip_px",
                 .unit = "px",
                 .help = "how far a road point may be from where it started after tracking forth and back",
                 .min = 0.01,
                 .max = 10},
                options.klt.max_round_trip_px);
  visitor.group("stereoscan", options.stereoscan);
}

void visit_fields(WarpSearchOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "min_step_m", .unit = "m", .help = "shortest distance tried", .min = 0.01, .max = 100},
                options.min_step_m);
  visitor.field({.key = "max_step_m", .unit = "m", .help = "longest distance tried", .min = 0.01, .max = 100},
                options.max_step_m);
  visitor.field({.key = "max_pitch_change_deg",
                 .unit = "deg",
                 .help = "the road's pitch is tried up to so far from what is expected",
                 .min = 0,
                 .max = 20},
                options.max_pitch_change_deg);
}

Matches track_on_road(const Image& first, const Image& second, const std::vector<TrackPoint>& points,
                      const RoadWarp& warp, const Camera& camera, const KltOptions& options) {
  if (points.empty()) return {};
  const cv::Rect area = area_of(points, first, 2 * options.window_px);
  const Eigen::Matrix3d homography = homography_of_plane(warp.road_in_cam1, warp.cam2_from_cam1);
  const WarpField field(area, camera,
                        [&homography](const Eigen::Vector3d& ray) -> Eigen::Vector3d { return homography * ray; });
  const Pyramid before(internal::crop(first, area), options.levels, options.window_px);
  const Pyramid after(field.warp(second), options.levels, options.window_px);
  const Eigen::Vector2d corner(area.x, area.y);
  std::vector<Eigen::Vector2d> starts;
  for (const TrackPoint& point : points) starts.push_back(point.pixel - corner);
  const auto found = track_points(before, after, starts, starts, options);
  Matches matches;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!found[i]) continue;
    const Eigen::Vector2d pixel2 = field.at(*found[i] + corner);
    if (camera.contains(pixel2)) matches.push_back({points[i].id, points[i].pixel, pixel2});
  }
  return matches;
}

WarpSearch search_warp(const Image& first, const Image& second, const Image& mask, const RoadWarp& guess,
                       const Camera& camera, const WarpSearchOptions& options) {
  WarpSearch best;
  best.correlation = -1.0;
  if (mask.empty()) return best;
  const RegionCorrelation correlation(first, second, mask, camera);
  constexpr double kStepFactor = 1.06;
  constexpr int kPitches = 5;
  const Eigen::Vector3d direction = guess.cam2_from_cam1.translation.normalized();
  // Pitch is a turn about the axis across the direction of travel.
  const Eigen::Vector3d across = guess.road_in_cam1.normal_in_cam.cross(direction).normalized();
  for (int k = 0; k < kPitches; ++k) {
    const double share = 2.0 * k / (kPitches - 1) - 1.0;
    const double turn = share * options.max_pitch_change_deg * std::numbers::pi / 180.0;
    const GroundPlane road{exp_so3(turn * across) * guess.road_in_cam1.normal_in_cam, guess.road_in_cam1.height};
    for (double step = options.min_step_m; step <= options.max_step_m; step *= kStepFactor) {
      const RoadWarp warp{{guess.cam2_from_cam1.rotation, step * direction}, road};
      const double value = correlation.of(homography_of_plane(road, warp.cam2_from_cam1));
      if (value > best.correlation) best = {warp, value};
    }
  }
  return best;
}

}  // namespace groundscale
