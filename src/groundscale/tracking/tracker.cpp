#include "groundscale/tracking/tracker.hpp"

#include <algorithm>
#include <cmath>

namespace groundscale {
namespace {

bool allowed(const Image& mask, const Eigen::Vector2d& pixel) {
  if (mask.empty()) return true;
  const int x = static_cast<int>(std::lround(pixel.x()));
  const int y = static_cast<int>(std::lround(pixel.y()));
  return x >= 0 && y >= 0 && x < mask.width() && y < mask.height() && mask.at(x, y) != 0;
}

}  // namespace

void visit_fields(TrackingOptions& options, FieldVisitor& visitor) {
  visitor.field(
      {.key = "max_tracks", .unit = "", .help = "points followed over the whole image", .min = 50, .max = 20000},
      options.max_tracks);
  visitor.field(
      {.key = "cell_px", .unit = "px", .help = "one new point at most in each cell of this size", .min = 8, .max = 200},
      options.detect.cell_px);
  visitor.field({.key = "min_gradient",
                 .unit = "grey levels/px",
                 .help = "weakest texture that a new point may have",
                 .min = 0.1,
                 .max = 100},
                options.detect.min_gradient);
  visitor.field({.key = "window_px", .unit = "px", .help = "side of the patch that is followed", .min = 5, .max = 61},
                options.klt.window_px);
  visitor.field({.key = "levels", .unit = "", .help = "halvings of the image for large motion", .min = 0, .max = 8},
                options.klt.levels);
  visitor.field({.key = "max_round_trip_px",
                 .unit = "px",
                 .help = "how far a point may be from where it started after tracking forth and back",
                 .min = 0.01,
                 .max = 10},
                options.klt.max_round_trip_px);
}

void Tracker::advance(const Pyramid& next, const Image& mask) {
  follow(next, mask);
  replenish(next, mask);
  last_ = next;
}

/// Points with a history go on as they went, which few levels of the pyramid can correct; new ones need all of them,
/// and start where they are.
std::vector<std::optional<Eigen::Vector2d>> Tracker::track(const Pyramid& next) const {
  constexpr int kLevelsWithHistory = 2;
  KltOptions few = options_.klt;
  few.levels = std::min(few.levels, kLevelsWithHistory);
  std::vector<std::optional<Eigen::Vector2d>> found(points_.size());
  for (const bool old : {true, false}) {
    std::vector<Eigen::Vector2d> starts;
    std::vector<Eigen::Vector2d> guesses;
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (steps_[i].has_value() != old) continue;
      which.push_back(i);
      starts.push_back(points_[i].pixel);
      guesses.push_back(points_[i].pixel + steps_[i].value_or(Eigen::Vector2d::Zero()));
    }
    const auto part = track_points(last_, next, starts, guesses, old ? few : options_.klt);
    for (std::size_t k = 0; k < which.size(); ++k) found[which[k]] = part[k];
  }
  return found;
}

void Tracker::follow(const Pyramid& next, const Image& mask) {
  followed_ = 0;
  if (last_.empty() || points_.empty()) return;
  const auto found = track(next);
  std::vector<TrackPoint> kept;
  std::vector<std::optional<Eigen::Vector2d>> steps;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!found[i] || !allowed(mask, *found[i])) continue;
    kept.push_back({points_[i].id, *found[i]});
    steps.emplace_back(*found[i] - points_[i].pixel);
  }
  points_ = std::move(kept);
  steps_ = std::move(steps);
  followed_ = static_cast<int>(points_.size());
}

void Tracker::revive(const std::vector<TrackPoint>& points) {
  for (const TrackPoint& point : points) {
    const auto place = std::lower_bound(points_.begin(), points_.end(), point.id,
                                        [](const TrackPoint& other, TrackId id) { return other.id < id; });
    if (place != points_.end() && place->id == point.id) continue;
    steps_.emplace(steps_.begin() + (place - points_.begin()));
    points_.insert(place, point);
    ++followed_;
  }
}

void Tracker::replenish(const Pyramid& frame, const Image& mask) {
  const int missing = options_.max_tracks - static_cast<int>(points_.size());
  if (missing <= 0) return;
  std::vector<Eigen::Vector2d> taken;
  for (const TrackPoint& point : points_) taken.push_back(point.pixel);
  const auto corners = detect_corners(frame.image(), mask, taken, options_.detect);
  // Every (n / missing)-th of the cells in their order, so that the image stays evenly covered.
  const auto count = static_cast<int>(corners.size());
  const int wanted = std::min(missing, count);
  for (int k = 0; k < wanted; ++k) {
    const auto index = static_cast<std::size_t>(static_cast<std::int64_t>(k) * count / wanted);
    points_.push_back({next_id_++, corners[index]});
    steps_.emplace_back();
  }
}

}  // namespace groundscale
