#include "groundscale/tracking/tracker.hpp"

#include <algorithm>
#include <utility>

namespace groundscale {

Tracker::Tracker(const Tracker& other)
    : max_tracks_(other.max_tracks_),
      front_end_(other.front_end_->clone()),
      points_(other.points_),
      steps_(other.steps_),
      followed_(other.followed_),
      next_id_(other.next_id_) {}

Tracker& Tracker::operator=(const Tracker& other) {
  if (this != &other) *this = Tracker(other);
  return *this;
}

void Tracker::advance(const Image& next, const Image& mask) {
  follow(next, mask);
  replenish(mask);
}

std::vector<Eigen::Vector2d> Tracker::pixels() const {
  std::vector<Eigen::Vector2d> pixels;
  for (const TrackPoint& point : points_) pixels.push_back(point.pixel);
  return pixels;
}

void Tracker::follow(const Image& next, const Image& mask) {
  const FrontEnd::Places found = front_end_->advance(next, pixels(), steps_);
  std::vector<TrackPoint> kept;
  FrontEnd::Places steps;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!found[i] || !wanted_by(mask, *found[i])) continue;
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

void Tracker::replenish(const Image& mask) {
  const int missing = max_tracks_ - static_cast<int>(points_.size());
  if (missing <= 0) return;
  for (const Eigen::Vector2d& pixel : front_end_->find(mask, pixels(), missing)) {
    points_.push_back({next_id_++, pixel});
    steps_.emplace_back();
  }
}

}  // namespace groundscale
