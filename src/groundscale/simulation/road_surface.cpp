#include "groundscale/simulation/road_surface.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

#include "groundscale/simulation/noise.hpp"

namespace groundscale {
namespace {

constexpr double kSampleM = 1.0;
constexpr double kCellM = 10.0;
/// Samples further apart along a path than this belong to different passes.
constexpr double kSamePassM = 30.0;

double squared_distance(const Eigen::Vector3d& a, double x, double z) {
  return (x - a.x()) * (x - a.x()) + (z - a.z()) * (z - a.z());
}

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

/// Whether the directions of two roads differ by more than those of one road's two lanes.
bool crosses(double heading1_rad, double heading2_rad) {
  constexpr double kLeast = 0.4;
  return std::abs(std::sin(heading1_rad - heading2_rad)) > kLeast;
}

std::vector<PathPoint> straight_on(const PathPoint& from, double step_m) {
  constexpr double kSideRoadM = 45.0;
  std::vector<PathPoint> places;
  for (double ahead = 0.0; ahead <= kSideRoadM; ahead += step_m) {
    PathPoint place = from;
    place.position += ahead * (from.forward() - from.slope * Eigen::Vector3d::UnitY());
    places.push_back(place);
  }
  return places;
}

/// Whether the path keeps away from the places, what lies between two of its distances aside.
bool clear_of_path(const Path& path, const std::vector<PathPoint>& places, double own_from_m, double own_to_m) {
  constexpr double kStepM = 2.0;
  constexpr double kApartM = 12.0;
  for (double s = 0.0; s < path.length_m(); s += kStepM) {
    if (s > own_from_m && s < own_to_m) continue;
    const Eigen::Vector3d on_path = path.at(s).position;
    for (const PathPoint& place : places) {
      if (squared_distance(on_path, place.position.x(), place.position.z()) < kApartM * kApartM) return false;
    }
  }
  return true;
}

}  // namespace

RoadSurface::RoadSurface(Path path, const RoadProfile& profile, std::vector<Path> side_roads) : profile_(profile) {
  roads_.push_back(std::move(path));
  std::move(side_roads.begin(), side_roads.end(), std::back_inserter(roads_));
  for (std::size_t road = 0; road < roads_.size(); ++road) {
    // The driven road goes on straight before the start and behind the end, so that both lie in a world.
    const double from_m = road == 0 ? -lead_m() : 0.0;
    const double to_m = roads_[road].length_m() + (road == 0 ? tail_m() : 0.0);
    for (double s = from_m; s <= to_m; s += kSampleM) {
      samples_.push_back({static_cast<int>(road), roads_[road].at(s)});
    }
  }
  const int reach = static_cast<int>(std::ceil(reach_m() / kCellM));
  for (int k = 0; k < static_cast<int>(samples_.size()); ++k) {
    const Eigen::Vector3d& position = samples_[static_cast<std::size_t>(k)].point.position;
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

RoadSurface::Pass RoadSurface::pass_at(const Sample& nearest, double x, double z) const {
  // From the sample to the foot of the perpendicular, twice for the curve's sake.
  const Path& path = roads_[static_cast<std::size_t>(nearest.road)];
  Pass pass;
  pass.road = nearest.road;
  const double step = std::clamp(ahead_of(nearest.point, x, z), -kSampleM, kSampleM);
  pass.on_path = path.at(nearest.point.distance_m + step);
  pass.on_path =
      path.at(pass.on_path.distance_m + std::clamp(ahead_of(pass.on_path, x, z), -0.5 * kSampleM, 0.5 * kSampleM));
  // Beyond a road's end its distance is that to the end, so that what lies ahead of a dead end isn't on it.
  const double beyond = std::max(0.0, std::abs(ahead_of(pass.on_path, x, z)) - kSampleM);
  const double lateral = lateral_of(pass.on_path, x, z);
  pass.lateral_m = std::copysign(std::hypot(lateral, beyond), lateral);
  pass.from_crest_m = pass.lateral_m + profile_.lane_offset_m;
  return pass;
}

std::vector<RoadSurface::Pass> RoadSurface::passes_at(double x, double z) const {
  std::vector<Pass> passes;
  const auto cell = cells_.find(cell_of(x, z));
  if (cell == cells_.end()) return passes;
  const auto same_pass = static_cast<int>(kSamePassM / kSampleM);
  int best = -1;
  double best_distance = std::numeric_limits<double>::infinity();  // squared
  const auto finish = [&] {
    if (best >= 0 && best_distance < reach_m() * reach_m())
      passes.push_back(pass_at(samples_[static_cast<std::size_t>(best)], x, z));
    best = -1;
    best_distance = std::numeric_limits<double>::infinity();
  };
  for (const int k : cell->second) {
    const Sample& sample = samples_[static_cast<std::size_t>(k)];
    const bool other =
        best >= 0 && (k - best > same_pass || samples_[static_cast<std::size_t>(best)].road != sample.road);
    if (other) finish();
    const double distance = squared_distance(sample.point.position, x, z);
    if (distance < best_distance) std::tie(best, best_distance) = std::pair(k, distance);
  }
  finish();
  return passes;
}

double RoadSurface::road_y(const std::vector<Pass>& passes) const {
  // Each pass extends its own cross-section; the nearer its lane, the more it counts, and what is driven counts more
  // than a side road. The differences between passes are small where both are near.
  constexpr double kFadeM = 0.7;
  constexpr double kSideRoadShare = 0.02;
  const auto softened = [](double lateral) { return std::hypot(lateral, 0.5); };
  double nearest = std::numeric_limits<double>::infinity();
  for (const Pass& pass : passes) nearest = std::min(nearest, softened(pass.lateral_m));
  double sum = 0.0;
  double weights = 0.0;
  for (const Pass& pass : passes) {
    const double weight =
        std::exp(-(softened(pass.lateral_m) - nearest) / kFadeM) * (pass.road == 0 ? 1.0 : kSideRoadShare);
    const double widest = profile_.half_width_m + profile_.lane_offset_m;
    const double fall =
        profile_.crown * (std::min(std::abs(pass.from_crest_m), profile_.half_width_m) - profile_.lane_offset_m) +
        pass.on_path.bank * std::clamp(pass.lateral_m, -widest, widest);
    sum += weight * (pass.on_path.position.y() + fall);
    weights += weight;
  }
  return sum / weights;
}

double RoadSurface::rise_beyond(double beyond_edge_m) const {
  const double beyond_pavement = beyond_edge_m - profile_.kerb_width_m - profile_.pavement_m;
  return profile_.kerb_m * std::clamp(beyond_edge_m / profile_.kerb_face_m, 0.0, 1.0) +
         profile_.verge_slope * std::clamp(beyond_pavement, 0.0, profile_.verge_m);
}

double RoadSurface::roughness(double x, double z, double beyond_edge_m) const {
  // Power over wave number falls with its square, as roads have it (ISO 8608); none at the kerb.
  constexpr double kOctaves = 3.0;
  constexpr double kPersistence = 0.7;
  constexpr double kFadeM = 0.5;
  const double share = std::clamp(-beyond_edge_m / kFadeM, 0.0, 1.0);
  if (share == 0.0 || profile_.roughness_m == 0.0) return 0.0;
  const double sum_of_squares = (1.0 - std::pow(kPersistence, 2.0 * kOctaves)) / (1.0 - kPersistence * kPersistence);
  const FractalNoise waves{.seed = 4711,
                           .longest_m = 3.0,
                           .octaves = static_cast<int>(kOctaves),
                           .first_sd = 1.0 / std::sqrt(sum_of_squares),
                           .persistence = kPersistence};
  return share * profile_.roughness_m * waves.at(x, z, 0.0);
}

RoadPlace RoadSurface::locate(double x, double z) const {
  RoadPlace place;
  place.from_crest_m = reach_m();
  place.beyond_edge_m = reach_m() - profile_.half_width_m;
  const std::vector<Pass> passes = passes_at(x, z);
  if (passes.empty()) return place;

  const Pass* owner = nullptr;
  for (const Pass& pass : passes) {
    const double aside = std::abs(pass.from_crest_m);
    place.beyond_edge_m = std::min(place.beyond_edge_m, aside - profile_.half_width_m);
    const bool covers = owner != nullptr && std::abs(owner->from_crest_m) <= profile_.half_width_m;
    if (owner == nullptr || (!covers && aside < std::abs(owner->from_crest_m))) owner = &pass;
  }
  for (const Pass& pass : passes) {
    if (&pass == owner || std::abs(pass.from_crest_m) > profile_.half_width_m) continue;
    if (crosses(pass.on_path.heading_rad, owner->on_path.heading_rad)) place.junction = true;
  }
  place.road = owner->road;
  place.on_path = owner->on_path;
  place.from_crest_m = owner->from_crest_m;
  place.ground_y = road_y(passes) - rise_beyond(place.beyond_edge_m) - roughness(x, z, place.beyond_edge_m);
  if (place.beyond_edge_m <= 0.0) {
    place.ground = Ground::kRoad;
  } else if (place.beyond_edge_m <= profile_.kerb_width_m) {
    place.ground = Ground::kKerb;
  } else if (place.beyond_edge_m <= profile_.kerb_width_m + profile_.pavement_m) {
    place.ground = Ground::kPavement;
  }
  return place;
}

Eigen::Vector3d RoadSurface::ground_normal(double x, double z) const {
  constexpr double kHalfM = 0.5;
  const double along_x = (ground_y(x + kHalfM, z) - ground_y(x - kHalfM, z)) / (2.0 * kHalfM);
  const double along_z = (ground_y(x, z + kHalfM) - ground_y(x, z - kHalfM)) / (2.0 * kHalfM);
  return Eigen::Vector3d(along_x, -1.0, along_z).normalized();
}

std::vector<Path> side_roads_of(const Path& path) {
  constexpr double kStepM = 1.0;
  constexpr double kTurningPerM = 0.03;
  constexpr double kLeastTurn = std::numbers::pi / 3.0;
  std::vector<Path> side_roads;
  double begin_m = -1.0;
  for (double s = 0.0; s < path.length_m(); s += kStepM) {
    const bool turning = std::abs(path.at(s).curvature_per_m) > kTurningPerM;
    if (turning && begin_m < 0.0) begin_m = s;
    if (turning || begin_m < 0.0) continue;
    const PathPoint from = path.at(begin_m - 2.0);
    if (std::abs(path.at(s).heading_rad - from.heading_rad) > kLeastTurn) {
      std::vector<PathPoint> places = straight_on(from, kStepM);
      // Of the turn itself nothing is asked.
      constexpr double kOwnM = 15.0;
      if (clear_of_path(path, places, begin_m - kOwnM, s + kOwnM)) {
        side_roads.push_back(Path::through(std::move(places)));
      }
    }
    begin_m = -1.0;
  }
  return side_roads;
}

}  // namespace groundscale
