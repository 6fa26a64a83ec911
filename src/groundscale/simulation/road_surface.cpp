#include "groundscale/simulation/road_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace groundscale {
namespace {

constexpr double kSampleM = 0.5;
constexpr double kCellM = 10.0;
/// Samples further apart along the path than this belong to different passes.
constexpr double kSamePassM = 30.0;

/// Right of the path's direction, seen from above.
double lateral_of(const PathPoint& point, double x, double z) {
  const double dx = x - point.position.x();
  const double dz = z - point.position.z();
  return dx * std::cos(point.heading_rad) - dz * std::sin(point.heading_rad);
}

double ahead_of(const PathPoint& point, double x, double z) {
  const double dx = x - point.position.x();
  const double dz = z - point.position.z();
  return dx * std::sin(point.heading_rad) + dz * std::cos(point.heading_rad);
}

}  // namespace

RoadSurface::RoadSurface(Path path, const RoadProfile& profile) : path_(std::move(path)), profile_(profile) {
  // The road goes on straight before the start and behind the end, so that both lie in a world.
  for (double s = -reach_m(); s <= path_.length_m() + 3.0 * reach_m(); s += kSampleM) samples_.push_back(path_.at(s));
  const int reach = static_cast<int>(std::ceil(reach_m() / kCellM));
  for (int k = 0; k < static_cast<int>(samples_.size()); ++k) {
    const Eigen::Vector3d& position = samples_[static_cast<std::size_t>(k)].position;
    for (int i = -reach; i <= reach; ++i) {
      for (int j = -reach; j <= reach; ++j) {
        cells_[cell_of(position.x() + i * kCellM, position.z() + j * kCellM)].push_back(k);
      }
    }
  }
}

std::int64_t RoadSurface::cell_of(double x, double z) const {
  const auto column = static_cast<std::int64_t>(std::floor(x / kCellM));
  const auto row = static_cast<std::int64_t>(std::floor(z / kCellM));
  return (column << 32) ^ (row & 0xffffffff);
}

RoadPlace RoadSurface::locate(double x, double z) const {
  RoadPlace place;
  place.from_crest_m = reach_m();
  const auto cell = cells_.find(cell_of(x, z));
  if (cell == cells_.end()) return place;

  // The nearest sample of each pass; the first pass whose road covers the place, else the nearest of all.
  const auto distance_to = [&](int k) {
    const Eigen::Vector3d& position = samples_[static_cast<std::size_t>(k)].position;
    return std::hypot(x - position.x(), z - position.z());
  };
  int chosen = -1;
  double chosen_distance = std::numeric_limits<double>::infinity();
  const double covered = profile_.half_width_m + profile_.lane_offset_m;
  const auto same_pass = static_cast<int>(kSamePassM / kSampleM);
  int best = -1;
  double best_distance = std::numeric_limits<double>::infinity();
  for (const int k : cell->second) {
    if (best >= 0 && k - best > same_pass) {
      if (best_distance < chosen_distance) std::tie(chosen, chosen_distance) = std::pair(best, best_distance);
      if (chosen_distance < covered) break;
      best = -1;
      best_distance = std::numeric_limits<double>::infinity();
    }
    const double distance = distance_to(k);
    if (distance < best_distance) std::tie(best, best_distance) = std::pair(k, distance);
  }
  if (chosen_distance >= covered && best_distance < chosen_distance) chosen = best;
  if (chosen < 0) return place;

  // From the sample to the foot of the perpendicular, twice for the curve's sake.
  const PathPoint& sample = samples_[static_cast<std::size_t>(chosen)];
  place.on_path = path_.at(sample.distance_m + std::clamp(ahead_of(sample, x, z), -kSampleM, kSampleM));
  const double rest = std::clamp(ahead_of(place.on_path, x, z), -kSampleM, kSampleM);
  place.on_path = path_.at(place.on_path.distance_m + rest);
  place.from_crest_m = lateral_of(place.on_path, x, z) + profile_.lane_offset_m;
  const double aside = std::abs(place.from_crest_m);
  if (aside <= profile_.half_width_m) {
    place.ground = Ground::kRoad;
  } else if (aside <= profile_.half_width_m + profile_.kerb_width_m) {
    place.ground = Ground::kKerb;
  } else if (aside <= profile_.half_width_m + profile_.kerb_width_m + profile_.pavement_m) {
    place.ground = Ground::kPavement;
  }
  return place;
}

double RoadSurface::rise(double from_crest_m) const {
  const double aside = std::abs(from_crest_m);
  const double on_road = std::min(aside, profile_.half_width_m);
  double rise = -profile_.crown * on_road;
  rise += profile_.kerb_m * std::clamp((aside - profile_.half_width_m) / profile_.kerb_face_m, 0.0, 1.0);
  const double beyond = aside - profile_.half_width_m - profile_.kerb_width_m - profile_.pavement_m;
  return rise + profile_.verge_slope * std::clamp(beyond, 0.0, profile_.verge_m);
}

double RoadSurface::ground_y(const RoadPlace& place) const {
  return place.on_path.position.y() - rise(place.from_crest_m) + rise(profile_.lane_offset_m);
}

double RoadSurface::ground_y(double x, double z) const { return ground_y(locate(x, z)); }

}  // namespace groundscale
