#include "groundscale/mapping/local_map.hpp"

#include <algorithm>
#include <cmath>

#include "groundscale/core/check.hpp"
#include "groundscale/mapping/triangulation.hpp"

namespace groundscale {
namespace {

constexpr int kMinSights = 2;

/// Distance in pixels between a sight and where the map has its point; nothing where it can't be seen.
std::optional<double> error_px(const Keyframe& keyframe, const Camera& camera, const Eigen::Vector3d& point_in_world,
                               const Eigen::Vector2d& pixel) {
  const auto expected = camera.project(keyframe.cam_from_world * point_in_world);
  if (!expected) return std::nullopt;
  return (*expected - pixel).norm();
}

Eigen::Vector3d centre_of(const Keyframe& keyframe) { return keyframe.cam_from_world.inverse().translation; }

/// c + scale (X - c), for points and for the centres of cameras. In this order X near c keeps all its digits.
Eigen::Vector3d scaled_about(const Eigen::Vector3d& c, double scale, const Eigen::Vector3d& point_in_world) {
  return c + scale * (point_in_world - c);
}
RigidTransform scaled_about(const Eigen::Vector3d& c, double scale, const RigidTransform& cam_from_world) {
  RigidTransform world_from_cam = cam_from_world.inverse();
  world_from_cam.translation = scaled_about(c, scale, world_from_cam.translation);
  return world_from_cam.inverse();
}

}  // namespace

void visit_fields(LocalMapOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "free_keyframes",
                 .unit = "",
                 .help = "latest keyframes that the bundle adjustment moves",
                 .min = 2,
                 .max = 100},
                options.free_keyframes);
  visitor.field(
      {.key = "fixed_keyframes", .unit = "", .help = "keyframes before them that hold it", .min = 2, .max = 100},
      options.fixed_keyframes);
  visitor.field(
      {.key = "max_points", .unit = "", .help = "landmarks in the bundle adjustment", .min = 30, .max = 100000},
      options.max_points);
  visitor.field(
      {.key = "min_parallax_px", .unit = "px", .help = "between the rays of a new landmark", .min = 0.1, .max = 100},
      options.min_parallax_px);
  visitor.field({.key = "max_error_px",
                 .unit = "px",
                 .help = "a sight farther off after the adjustment is left out",
                 .min = 0.1,
                 .max = 100},
                options.max_error_px);
  visitor.field({.key = "strikes",
                 .unit = "frames",
                 .help = "in a row in which a landmark may disagree before it is dropped",
                 .min = 1,
                 .max = 100},
                options.strikes);
  visitor.group("bundle", options.bundle);
}

void LocalMap::clear() {
  keyframes_.clear();
  landmarks_.clear();
  boundary_ = next_serial_;
}

const Keyframe* LocalMap::find(int serial) const {
  if (keyframes_.empty()) return nullptr;
  const int index = serial - keyframes_.front().serial;
  if (index < 0 || index >= static_cast<int>(keyframes_.size())) return nullptr;
  return &keyframes_[static_cast<std::size_t>(index)];
}

const Eigen::Vector3d* LocalMap::point_of(TrackId id) const {
  const auto found = landmarks_.find(id);
  return found != landmarks_.end() && found->second.point_in_world ? &*found->second.point_in_world : nullptr;
}

int LocalMap::point_count() const {
  return static_cast<int>(std::count_if(landmarks_.begin(), landmarks_.end(),
                                        [](const auto& entry) { return entry.second.point_in_world.has_value(); }));
}

void LocalMap::use_camera(CameraPtr camera) {
  camera_ = std::move(camera);
  for (auto& [id, landmark] : landmarks_) {
    std::erase_if(landmark.sights, [this](Landmark::Sight& sight) {
      const auto ray = camera_->ray(sight.pixel);
      if (ray) sight.ray = *ray;
      return !ray.has_value();
    });
  }
}

int LocalMap::add(int frame, const RigidTransform& cam_from_world, const std::vector<TrackPoint>& points) {
  const int serial = next_serial_++;
  keyframes_.push_back({.serial = serial, .frame = frame, .cam_from_world = cam_from_world, .points = points});
  for (const TrackPoint& point : points) {
    const auto ray = camera_->ray(point.pixel);
    if (ray) landmarks_[point.id].sights.push_back({serial, point.pixel, *ray});
  }
  forget_old();
  return serial;
}

void LocalMap::forget_old() {
  const auto most = static_cast<std::size_t>(options_.free_keyframes + options_.fixed_keyframes);
  while (keyframes_.size() > most) keyframes_.pop_front();
  const int oldest = std::max(boundary_, keyframes_.front().serial);
  const int latest = keyframes_.back().serial;
  for (auto& [id, landmark] : landmarks_) {
    std::erase_if(landmark.sights, [oldest](const Landmark::Sight& sight) { return sight.keyframe < oldest; });
  }
  std::erase_if(landmarks_, [latest](const auto& entry) {
    const Landmark& landmark = entry.second;
    const bool alive = !landmark.sights.empty() && landmark.sights.back().keyframe == latest;
    // One that moves is remembered for as long as it is followed.
    return landmark.sights.empty() || (landmark.rejected && !alive);
  });
}

void LocalMap::retriangulate(Landmark& landmark) {
  std::vector<Sight> sights;
  sights.reserve(landmark.sights.size());
  for (const Landmark::Sight& sight : landmark.sights) {
    const Keyframe* keyframe = find(sight.keyframe);
    if (keyframe != nullptr) sights.push_back({keyframe->cam_from_world, sight.ray, sight.pixel});
  }
  if (sights.size() < kMinSights) return;
  const auto point = groundscale::triangulate(sights, *camera_);
  if (!point || point->parallax_rad * camera_->focal_px() < options_.min_parallax_px ||
      point->rms_px > options_.max_error_px) {
    return;
  }
  landmark.point_in_world = point->point_in_world;
}

int LocalMap::triangulate() {
  GS_CHECK(!keyframes_.empty(), "a map with keyframes");
  int made = 0;
  for (const TrackPoint& track : keyframes_.back().points) {
    const auto found = landmarks_.find(track.id);
    if (found == landmarks_.end()) continue;
    Landmark& landmark = found->second;
    if (landmark.rejected || landmark.point_in_world) continue;
    retriangulate(landmark);
    if (landmark.point_in_world) ++made;
  }
  return made;
}

/// After a correction what lies before it takes no part, and the corrected part's own beginning holds it.
LocalMap::Window LocalMap::window() const {
  Window window;
  while (window.begin < keyframes_.size() && keyframes_[window.begin].serial < boundary_) ++window.begin;
  const auto free = static_cast<std::size_t>(options_.free_keyframes);
  window.free = std::max(window.begin + 1, keyframes_.size() > free ? keyframes_.size() - free : 0);
  const bool held_by_one = window.begin > 0 && window.free == window.begin + 1;
  if (held_by_one && keyframes_.size() > window.free + 1) ++window.free;
  return window;
}

/// Landmarks that a free keyframe sees; those with most sights where there are too many.
std::vector<Landmark*> LocalMap::landmarks_in(const Window& window) {
  const int free_serial = keyframes_[window.free].serial;
  std::vector<Landmark*> seen;
  for (auto& [id, landmark] : landmarks_) {
    if (!landmark.point_in_world || landmark.sights.size() < kMinSights) continue;
    if (landmark.sights.back().keyframe >= free_serial) seen.push_back(&landmark);
  }
  std::stable_sort(seen.begin(), seen.end(),
                   [](const Landmark* a, const Landmark* b) { return a->sights.size() > b->sights.size(); });
  return seen;
}

Bundle LocalMap::bundle_of(const Window& window, std::span<Landmark* const> landmarks) const {
  Bundle bundle;
  bundle.camera = camera_;
  for (std::size_t k = window.begin; k < keyframes_.size(); ++k) {
    const Keyframe& keyframe = keyframes_[k];
    const int view = static_cast<int>(k - window.begin);
    bundle.views.push_back({keyframe.cam_from_world, k < window.free});
    if (view > 0 && k >= window.free && keyframe.distance) {
      bundle.distances.push_back({view - 1, view, *keyframe.distance, keyframe.distance_log_sd});
    }
  }
  const int first_serial = keyframes_[window.begin].serial;
  for (const Landmark* landmark : landmarks) {
    const int point = static_cast<int>(bundle.points_in_world.size());
    bundle.points_in_world.push_back(*landmark->point_in_world);
    for (const Landmark::Sight& sight : landmark->sights) {
      if (sight.keyframe < first_serial) continue;
      bundle.observations.push_back({sight.keyframe - first_serial, point, sight.pixel});
    }
  }
  return bundle;
}

/// One fixed keyframe leaves the scale open: it stays that of the way up to the last keyframe but one.
double LocalMap::scale_kept(const Window& window, const Bundle& bundle) const {
  if (window.free != window.begin + 1 || !bundle.distances.empty()) return 1.0;
  const Eigen::Vector3d origin = centre_of(keyframes_[window.begin]);
  const std::size_t reference = std::max(window.begin + 1, keyframes_.size() - 2);
  const double before = (centre_of(keyframes_[reference]) - origin).norm();
  const double after = (bundle.views[reference - window.begin].cam_from_world.inverse().translation - origin).norm();
  return after > 0.0 ? before / after : 1.0;
}

void LocalMap::adjust() {
  const Window window = this->window();
  if (keyframes_.size() <= window.free) return;
  const std::vector<Landmark*> seen = landmarks_in(window);
  const std::size_t used = std::min(seen.size(), static_cast<std::size_t>(options_.max_points));
  Bundle bundle = bundle_of(window, std::span(seen).first(used));
  if (!adjust_bundle(bundle, options_.bundle)) return;

  const double scale = scale_kept(window, bundle);
  const Eigen::Vector3d origin = centre_of(keyframes_[window.begin]);
  for (std::size_t k = window.free; k < keyframes_.size(); ++k) {
    keyframes_[k].cam_from_world = scaled_about(origin, scale, bundle.views[k - window.begin].cam_from_world);
  }
  for (std::size_t i = 0; i < used; ++i) {
    seen[i]->point_in_world = scaled_about(origin, scale, bundle.points_in_world[i]);
  }
  for (std::size_t i = used; i < seen.size(); ++i) retriangulate(*seen[i]);
  drop_bad_sights();
}

void LocalMap::drop_bad_sights() {
  for (auto& entry : landmarks_) {
    Landmark& landmark = entry.second;
    if (!landmark.point_in_world) continue;
    const std::size_t before = landmark.sights.size();
    std::erase_if(landmark.sights, [this, &landmark](const Landmark::Sight& sight) {
      const Keyframe* keyframe = find(sight.keyframe);
      if (keyframe == nullptr) return true;
      const auto error = error_px(*keyframe, *camera_, *landmark.point_in_world, sight.pixel);
      return !error || *error > options_.max_error_px;
    });
    if (landmark.sights.size() >= kMinSights && 2 * landmark.sights.size() >= before) continue;
    landmark.point_in_world.reset();
    landmark.rejected = true;
  }
}

void LocalMap::judge(const std::vector<TrackId>& ids, const std::vector<bool>& agreed) {
  GS_CHECK(ids.size() == agreed.size(), "a verdict for each landmark");
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto found = landmarks_.find(ids[i]);
    if (found == landmarks_.end()) continue;
    Landmark& landmark = found->second;
    landmark.strikes = agreed[i] ? 0 : landmark.strikes + 1;
    if (landmark.strikes < options_.strikes) continue;
    landmark.point_in_world.reset();
    landmark.rejected = true;
  }
}

void LocalMap::set_distance(double distance, double log_sd) {
  GS_CHECK(!keyframes_.empty() && distance > 0.0 && log_sd > 0.0, "a distance of the latest keyframe");
  keyframes_.back().distance = distance;
  keyframes_.back().distance_log_sd = log_sd;
}

const Keyframe& LocalMap::scale(double lambda) {
  GS_CHECK(lambda > 0.0 && !keyframes_.empty(), "a positive factor for a map with keyframes");
  const auto free = static_cast<std::size_t>(options_.free_keyframes);
  const std::size_t begin = keyframes_.size() > free ? keyframes_.size() - free : 0;
  boundary_ = keyframes_[begin].serial;
  const Eigen::Vector3d origin = centre_of(keyframes_[begin]);
  for (std::size_t k = begin; k < keyframes_.size(); ++k) {
    keyframes_[k].cam_from_world = scaled_about(origin, lambda, keyframes_[k].cam_from_world);
  }
  for (auto& [id, landmark] : landmarks_) {
    if (landmark.point_in_world) landmark.point_in_world = scaled_about(origin, lambda, *landmark.point_in_world);
  }
  forget_old();
  return *find(boundary_);
}

}  // namespace groundscale
