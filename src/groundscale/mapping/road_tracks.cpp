#include "groundscale/mapping/road_tracks.hpp"

#include <algorithm>

#include "groundscale/mapping/triangulation.hpp"

namespace groundscale {

void visit_fields(RoadTracksOptions& options, FieldVisitor& visitor) {
  visitor.field(
      {.key = "min_parallax_px", .unit = "px", .help = "between the rays of a road point", .min = 0.1, .max = 100},
      options.min_parallax_px);
  visitor.field(
      {.key = "max_error_px", .unit = "px", .help = "rms reprojection error of a road point", .min = 0.1, .max = 20},
      options.max_error_px);
  visitor.field({.key = "max_sights", .unit = "", .help = "of a point, spread over its views", .min = 2, .max = 100},
                options.max_sights);
}

void RoadTracks::clear() {
  view_ = {};
  view_frame_ = -1;
  matches_.clear();
  matches_frame_ = -1;
  tracks_.clear();
}

void RoadTracks::use_camera(CameraPtr camera) {
  camera_ = std::move(camera);
  for (auto& [id, track] : tracks_) {
    for (Track::Sight& sight : track.sights) sight.ray = camera_->ray(sight.pixel).value_or(sight.ray);
  }
}

void RoadTracks::add_sight(TrackId id, int frame, const Eigen::Vector2d& pixel) {
  const auto ray = camera_->ray(pixel);
  if (!ray) return;
  auto& sights = tracks_[id].sights;
  if (!sights.empty() && sights.back().frame == frame) return;
  sights.push_back({frame, pixel, *ray});
}

const Matches& RoadTracks::follow(const Image& image, int frame, const RoadWarp& frame_from_view) {
  matches_.clear();
  matches_frame_ = frame;
  if (view_.points.empty()) return matches_;
  matches_ = matcher_.match(view_, image, frame_from_view, /*fine=*/true, *camera_);
  for (const Match& match : matches_) add_sight(match.id, frame, match.pixel2);
  return matches_;
}

void RoadTracks::look(const Image& image, int frame, const Image& region) {
  view_.image = image;
  view_.points.clear();
  view_.features = {};
  if (matches_frame_ == frame) {
    for (const Match& match : matches_) view_.points.push_back({match.id, match.pixel2});
  }
  matches_.clear();
  matcher_.fill(view_, region);
  view_frame_ = frame;
  for (const TrackPoint& point : view_.points) add_sight(point.id, frame, point.pixel);
}

void RoadTracks::forget_before(int frame) {
  std::erase_if(tracks_, [frame](const auto& entry) { return entry.second.sights.back().frame < frame; });
}

std::vector<RoadTracks::Point> RoadTracks::points(const std::vector<RigidTransform>& cam_from_world,
                                                  int first_frame) const {
  std::vector<Point> result;
  TriangulationOptions options;
  options.min_parallax_rad = options_.min_parallax_px / camera_->focal_px();
  const int end_frame = first_frame + static_cast<int>(cam_from_world.size());
  std::vector<Sight> sights;
  for (const auto& [id, track] : tracks_) {
    const auto sight_before = [](const Track::Sight& sight, int frame) { return sight.frame < frame; };
    const auto begin = std::lower_bound(track.sights.begin(), track.sights.end(), first_frame, sight_before);
    const auto end = std::lower_bound(begin, track.sights.end(), end_frame, sight_before);
    const auto count = static_cast<int>(end - begin);
    constexpr int kMinSights = 3;
    if (count < kMinSights) continue;
    sights.clear();
    const int used = std::clamp(options_.max_sights, 2, count);
    for (int k = 0; k < used; ++k) {
      const Track::Sight& sight = *(begin + k * (count - 1) / (used - 1));
      sights.push_back({cam_from_world[static_cast<std::size_t>(sight.frame - first_frame)], sight.ray, sight.pixel});
    }
    const auto point = triangulate(sights, *camera_, options);
    if (!point || point->rms_px > options_.max_error_px) continue;
    result.push_back({id, point->point_in_world, (begin->frame + track.sights.back().frame) / 2});
  }
  return result;
}

}  // namespace groundscale
