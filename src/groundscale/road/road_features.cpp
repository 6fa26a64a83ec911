#include "groundscale/road/road_features.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "groundscale/road/crop_internal.hpp"
#include "groundscale/road/warp_field_internal.hpp"
#include "groundscale/tracking/front_end.hpp"

namespace groundscale {

RoadFeatures find_road_features(const Image& image, const Image& region, const StereoScanOptions& options) {
  constexpr int kMarginPx = 24;  // for what patches and neighbourhoods reach over
  const cv::Rect inside = cv::boundingRect(view_of(region));
  if (inside.empty()) return {};
  const cv::Rect area = cv::Rect(inside.x - kMarginPx, inside.y - kMarginPx, inside.width + 2 * kMarginPx,
                                 inside.height + 2 * kMarginPx) &
                        cv::Rect(0, 0, image.width(), image.height());
  return {FeatureSet(internal::crop(image, area), options), {area.x, area.y}};
}

std::vector<Eigen::Vector2d> places_in(const RoadFeatures& features, const Image& region) {
  if (features.features.empty()) return {};
  std::vector<Feature> inside;
  for (const Feature& feature : features.features.features()) {
    if (wanted_by(region, {feature.x + features.corner.x(), feature.y + features.corner.y()})) {
      inside.push_back(feature);
    }
  }
  std::stable_sort(inside.begin(), inside.end(),
                   [](const Feature& a, const Feature& b) { return a.strength > b.strength; });
  std::vector<Eigen::Vector2d> places;
  for (const Feature& feature : inside) {
    places.emplace_back(feature.x + features.corner.x(), feature.y + features.corner.y());
  }
  return places;
}

Matches match_on_road(const RoadFeatures& first, const Image& second, const std::vector<TrackPoint>& points,
                      const RoadWarp& warp, const Camera& camera, const StereoScanOptions& options) {
  if (points.empty() || first.features.empty()) return {};
  const Image& part = first.features.image();
  const cv::Rect area(first.corner.x(), first.corner.y(), part.width(), part.height());
  const Eigen::Matrix3d homography = homography_of_plane(warp.road_in_cam1, warp.cam2_from_cam1);
  const WarpField field(area, camera,
                        [&homography](const Eigen::Vector3d& ray) -> Eigen::Vector3d { return homography * ray; });
  const FeatureSet after(field.warp(second), options);
  const Eigen::Vector2d corner = first.corner.cast<double>();
  std::vector<Eigen::Vector2d> starts;
  for (const TrackPoint& point : points) starts.push_back(point.pixel - corner);
  const auto found =
      follow_features(first.features, after, match_features(first.features, after, options), starts, options);
  Matches matches;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!found[i]) continue;
    const Eigen::Vector2d pixel2 = field.at(*found[i] + corner);
    if (camera.contains(pixel2)) matches.push_back({points[i].id, points[i].pixel, pixel2});
  }
  return matches;
}

}  // namespace groundscale
