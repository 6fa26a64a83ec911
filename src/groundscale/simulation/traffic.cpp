#include "groundscale/simulation/traffic.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "groundscale/core/check.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/simulation/roadside.hpp"

namespace groundscale {
namespace {

constexpr double kLeastHeadwayS = 3.0;
/// Nobody who comes towards the vehicle is slower: at 3 s between them they are 9 m apart.
constexpr double kLeastSpeedMps = 3.0;
/// From middle to middle of cars that stand in a queue.
constexpr double kQueueM = 7.5;
/// Parked cars are numbered from 1; there are fewer than this.
constexpr int kFirstVariant = 30000;

/// y at x of a line through points of ascending xs, going on beyond both ends at `before` and `behind` per x.
double interpolated(const std::vector<double>& xs, const std::vector<double>& ys, double x, double before,
                    double behind) {
  if (x <= xs.front()) return ys.front() + before * (x - xs.front());
  if (x >= xs.back()) return ys.back() + behind * (x - xs.back());
  const auto after = static_cast<std::size_t>(std::upper_bound(xs.begin(), xs.end(), x) - xs.begin());
  const double share = (x - xs[after - 1]) / (xs[after] - xs[after - 1]);
  return ys[after - 1] + share * (ys[after] - ys[after - 1]);
}

}  // namespace

Traffic::Traffic(const RoadSurface& surface, const std::vector<VehicleState>& drive, const TrafficOptions& options,
                 std::uint64_t seed)
    : surface_(surface), options_(options) {
  GS_CHECK(drive.size() >= 2, "a drive has states");
  double flowing_s = 0.0;
  for (const VehicleState& state : drive) {
    if (!times_s_.empty()) {
      const double moved = state.distance_m - distances_m_.back();
      const double lasted = state.time_s - times_s_.back();
      GS_CHECK(lasted > 0.0 && moved >= 0.0, "states by time, driven forwards");
      flowing_s += std::min(lasted, moved / kLeastSpeedMps);
    }
    times_s_.push_back(state.time_s);
    distances_m_.push_back(state.distance_m);
    flowing_s_.push_back(flowing_s);
  }
  first_speed_mps_ = std::max(kLeastSpeedMps, drive.front().speed_mps);
  last_speed_mps_ = std::max(kLeastSpeedMps, drive.back().speed_mps);

  Rng rng(seed ^ 0x74726166666963ULL);
  int variant = kFirstVariant;
  const auto driver = [&](double time_s) {
    Driver made;
    Rng own(rng.next());
    made.kind = random_car_kind(own);
    made.variant = ++variant;
    made.time_s = time_s;
    made.aside_m = std::clamp(0.12 * own.normal(), -0.25, 0.25);
    return made;
  };
  for (int k = 1; k <= options.ahead; ++k) ahead_.push_back(driver(k * options.gap_s));
  if (options.oncoming_every_s <= 0.0) return;
  // Enough for the whole of what is in sight, from the first moment to the last.
  const double reach_s = options.visible_m / kLeastSpeedMps;
  const double end_s = times_s_.back() + flowing_s_.back() + reach_s - times_s_.front();
  const double mean_s = std::max(kLeastHeadwayS, options.oncoming_every_s);
  for (double t = -reach_s + rng.uniform() * mean_s; t < end_s;
       t += kLeastHeadwayS + 2.0 * (mean_s - kLeastHeadwayS) * rng.uniform()) {
    oncoming_.push_back(driver(t));
  }
}

double Traffic::distance_at(double time_s) const {
  return interpolated(times_s_, distances_m_, time_s, first_speed_mps_, last_speed_mps_);
}

double Traffic::oncoming_distance(const Driver& driver, double time_s) const {
  // The vehicle's drive backwards, halts left out.
  const double flowing = driver.time_s - (time_s - times_s_.front());
  return interpolated(flowing_s_, distances_m_, flowing, first_speed_mps_, last_speed_mps_);
}

MovingCar Traffic::place(const Driver& driver, double distance_m, bool oncoming) const {
  const PathPoint point = surface_.path().at(distance_m);
  // The path runs in the middle of its lane; the other lane lies as far to the left of the crest.
  const double aside = (oncoming ? -2.0 * surface_.profile().lane_offset_m : 0.0) + driver.aside_m;
  const double heading = point.heading_rad + (oncoming ? std::numbers::pi : 0.0);
  MovingCar car;
  car.kind = driver.kind;
  car.variant = driver.variant;
  car.oncoming = oncoming;
  car.distance_m = distance_m;
  car.foot = car_footing(surface_, point.position + aside * point.right(), heading);
  return car;
}

std::vector<MovingCar> Traffic::cars_at(double time_s) const {
  const double own_m = distance_at(time_s);
  TakenGround taken;
  const PathPoint here = surface_.path().at(own_m);
  taken.take({here.position, here.forward(), here.right()}, 0.5 * options_.vehicle_length_m,
             options_.vehicle_half_width_m);
  std::vector<MovingCar> cars;
  const auto add = [&](const Driver& driver, double distance_m, bool oncoming) {
    if (std::abs(distance_m - own_m) > options_.visible_m) return;
    MovingCar car = place(driver, distance_m, oncoming);
    const CarSize size = car_size(car.kind);
    // The road doesn't go on for ever behind the path's ends.
    for (const double along : {-0.5 * size.length_m, 0.5 * size.length_m}) {
      const Eigen::Vector3d end = car.foot.at(0.0, 0.0, along);
      if (surface_.locate(end.x(), end.z()).ground != Ground::kRoad) return;
    }
    if (taken.take(car.foot, 0.5 * size.length_m, size.half_width_m)) cars.push_back(std::move(car));
  };
  for (std::size_t k = 0; k < ahead_.size(); ++k) {
    add(ahead_[k], distance_at(time_s + ahead_[k].time_s) + static_cast<double>(k + 1) * kQueueM, false);
  }
  for (const Driver& driver : oncoming_) add(driver, oncoming_distance(driver, time_s), true);
  return cars;
}

Meshes Traffic::at(double time_s) const {
  Meshes meshes;
  for (const MovingCar& car : cars_at(time_s)) append(meshes, car_meshes(car.foot, car.kind, car.variant));
  return meshes;
}

}  // namespace groundscale
