#include "groundscale/road/road_matcher.hpp"

#include <algorithm>

#include "groundscale/tracking/bucketing.hpp"

namespace groundscale {
namespace {

std::vector<Eigen::Vector2d> pixels_of(const std::vector<TrackPoint>& points) {
  std::vector<Eigen::Vector2d> pixels;
  for (const TrackPoint& point : points) pixels.push_back(point.pixel);
  return pixels;
}

}  // namespace

void RoadMatcher::fill(RoadView& view, const Image& region) {
  if (region.empty()) {
    view.points.clear();
    return;
  }
  std::erase_if(view.points, [&region](const TrackPoint& point) { return !wanted_by(region, point.pixel); });
  for (const Eigen::Vector2d& pixel : new_places(view, region)) view.points.push_back({next_id_++, pixel});
}

std::vector<Eigen::Vector2d> RoadMatcher::new_places(RoadView& view, const Image& region) const {
  const std::vector<Eigen::Vector2d> taken = pixels_of(view.points);
  const auto present = static_cast<int>(taken.size());
  if (!by_features_) {
    return thin_out(detect_corners(view.image, region, taken, options_.detect), options_.max_points - present);
  }
  // Not every feature has its like in the next image: more are tried than are wanted.
  constexpr int kTried = 3;
  view.features = find_road_features(view.image, region, options_.stereoscan);
  const std::vector<Eigen::Vector2d> places = places_in(view.features, region);
  std::vector<Eigen::Vector2d> chosen;
  for (const std::size_t k :
       pick_evenly(places, taken, options_.detect.cell_px, kTried * options_.max_points - present)) {
    chosen.push_back(places[k]);
  }
  return chosen;
}

Matches RoadMatcher::match_roughly(const RoadView& first, const Image& second, const RoadWarp& warp,
                                   const Camera& camera) const {
  std::vector<TrackPoint> some;
  const std::size_t stride = 1 + first.points.size() / static_cast<std::size_t>(options_.rough_points);
  for (std::size_t i = 0; i < first.points.size(); i += stride) some.push_back(first.points[i]);
  if (by_features_) return match_on_road(first.features, second, some, warp, camera, options_.stereoscan);
  return track_on_road(first.image, second, some, warp, camera, options_.klt);
}

Matches RoadMatcher::match(const RoadView& first, const Image& second, const RoadWarp& warp, bool fine,
                           const Camera& camera) const {
  if (!by_features_) {
    KltOptions klt = options_.klt;
    if (fine) klt.levels = options_.fine_levels;
    return track_on_road(first.image, second, first.points, warp, camera, klt);
  }
  // No more than are wanted: evenly spread, those with a history before new ones.
  const Matches all = match_on_road(first.features, second, first.points, warp, camera, options_.stereoscan);
  std::vector<Eigen::Vector2d> pixels;
  for (const Match& match : all) pixels.push_back(match.pixel1);
  std::vector<std::size_t> chosen = pick_evenly(pixels, {}, options_.detect.cell_px, options_.max_points);
  std::sort(chosen.begin(), chosen.end());
  Matches matches;
  for (const std::size_t k : chosen) matches.push_back(all[k]);
  return matches;
}

}  // namespace groundscale
