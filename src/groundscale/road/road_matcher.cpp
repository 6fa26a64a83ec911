#include "groundscale/road/road_matcher.hpp"

#include <algorithm>
#include <cmath>

namespace groundscale {

void RoadMatcher::fill(RoadView& view, const Image& region) {
  if (region.empty()) {
    view.points.clear();
    return;
  }
  const auto outside = [&region](const TrackPoint& point) {
    const int x = static_cast<int>(std::lround(point.pixel.x()));
    const int y = static_cast<int>(std::lround(point.pixel.y()));
    return x < 0 || y < 0 || x >= region.width() || y >= region.height() || region.at(x, y) == 0;
  };
  std::erase_if(view.points, outside);
  std::vector<Eigen::Vector2d> taken;
  for (const TrackPoint& point : view.points) taken.push_back(point.pixel);
  const auto corners = detect_corners(view.image, region, taken, options_.detect);
  const int missing = options_.max_points - static_cast<int>(view.points.size());
  const auto count = static_cast<int>(corners.size());
  const int wanted = std::clamp(missing, 0, count);
  // Every (n / missing)-th in the grid's order, so that the region stays evenly covered.
  for (int k = 0; k < wanted; ++k) {
    const auto index = static_cast<std::size_t>(static_cast<std::int64_t>(k) * count / wanted);
    view.points.push_back({next_id_++, corners[index]});
  }
}

Matches RoadMatcher::match_roughly(const RoadView& first, const Image& second, const RoadWarp& warp,
                                   const Camera& camera) const {
  std::vector<TrackPoint> some;
  const std::size_t stride = 1 + first.points.size() / static_cast<std::size_t>(options_.rough_points);
  for (std::size_t i = 0; i < first.points.size(); i += stride) some.push_back(first.points[i]);
  return track_on_road(first.image, second, some, warp, camera, options_.klt);
}

Matches RoadMatcher::match(const RoadView& first, const Image& second, const RoadWarp& warp, bool fine,
                           const Camera& camera) const {
  KltOptions klt = options_.klt;
  if (fine) klt.levels = options_.fine_levels;
  return track_on_road(first.image, second, first.points, warp, camera, klt);
}

}  // namespace groundscale
