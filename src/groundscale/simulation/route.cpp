#include "groundscale/simulation/route.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "groundscale/core/check.hpp"
#include "groundscale/simulation/named_internal.hpp"

namespace groundscale {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

void append(std::vector<PathPiece>& pieces, const std::vector<PathPiece>& more) {
  pieces.insert(pieces.end(), more.begin(), more.end());
}

/// A block: four sides and four right turns alike, so that the end lies on the start; then some of the first side
/// again.
Route city() {
  std::vector<PathPiece> pieces;
  constexpr double kHalfSideM = 55.0;
  for (int side = 0; side < 4; ++side) {
    pieces.push_back({kHalfSideM, 0.0});
    append(pieces, turn_pieces(90.0 * kRadPerDeg, 9.0, 6.0));
    pieces.push_back({kHalfSideM, 0.0});
  }
  pieces.push_back({kHalfSideM, 0.0});
  return {Path::of_pieces(pieces, {}), Surroundings::kTown, 10.0, {}, 0.0};
}

Route straight() { return {Path::of_pieces({{1000.0, 0.0}}, {{0.4, 310.0, 0.0}}), Surroundings::kTown, 13.0, {}, 0.0}; }

Route hills() {
  std::vector<PathPiece> pieces{{60.0, 0.0}};
  const std::pair<double, double> turns[] = {{35.0, 60.0}, {-50.0, 45.0}, {25.0, 90.0}, {-20.0, 120.0},
                                             {60.0, 40.0}, {-70.0, 50.0}, {30.0, 70.0}};
  for (const auto& [angle_deg, radius_m] : turns) {
    append(pieces, turn_pieces(angle_deg * kRadPerDeg, radius_m, 15.0));
    pieces.push_back({40.0, 0.0});
  }
  return {Path::of_pieces(pieces, {{4.0, 260.0, 0.0}, {1.0, 95.0, 1.0}}), Surroundings::kCountry, 15.0, {}, 0.0};
}

Route stop_and_go() {
  std::vector<PathPiece> pieces{{120.0, 0.0}};
  append(pieces, turn_pieces(-90.0 * kRadPerDeg, 10.0, 7.0));
  pieces.push_back({180.0, 0.0});
  return {Path::of_pieces(pieces, {}), Surroundings::kTown, 9.0, {30.0, 75.0, 115.0, 190.0, 240.0}, 4.0};
}

Route motorway() {
  std::vector<PathPiece> pieces{{500.0, 0.0}};
  append(pieces, turn_pieces(25.0 * kRadPerDeg, 900.0, 150.0));
  pieces.push_back({400.0, 0.0});
  append(pieces, turn_pieces(-20.0 * kRadPerDeg, 1200.0, 150.0));
  pieces.push_back({500.0, 0.0});
  return {Path::of_pieces(pieces, {{3.0, 700.0, 0.5}}), Surroundings::kMotorway, 25.0, {}, 0.0};
}

struct NamedRoute {
  std::string_view name;
  Route (*make)();
};
constexpr NamedRoute kRoutes[] = {
    {"city", city}, {"straight", straight}, {"hills", hills}, {"stop-and-go", stop_and_go}, {"motorway", motorway}};

/// Highest speed at each sample of the path, `spacing_m` apart.
std::vector<double> speed_limits(const Route& route, double spacing_m, const DrivingLimits& limits) {
  const auto count = static_cast<std::size_t>(std::floor(route.path.length_m() / spacing_m)) + 1;
  std::vector<double> speeds(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double curvature = std::abs(route.path.at(static_cast<double>(k) * spacing_m).curvature_per_m);
    speeds[k] = std::min(route.cruise_mps, curvature > 0.0 ? std::sqrt(limits.lateral_mps2 / curvature) : HUGE_VAL);
  }
  for (const double stop : route.stops_m) {
    const auto k = static_cast<std::size_t>(std::lround(stop / spacing_m));
    GS_CHECK(k < count, "stops lie on the path");
    speeds[k] = 0.0;
  }
  // v^2 changes by at most 2 a ds from one sample to the next, from behind for braking and from the front for speed.
  for (std::size_t k = count - 1; k-- > 0;) {
    speeds[k] = std::min(speeds[k], std::sqrt(speeds[k + 1] * speeds[k + 1] + 2.0 * limits.braking_mps2 * spacing_m));
  }
  for (std::size_t k = 1; k < count; ++k) {
    speeds[k] =
        std::min(speeds[k], std::sqrt(speeds[k - 1] * speeds[k - 1] + 2.0 * limits.acceleration_mps2 * spacing_m));
  }
  return speeds;
}

}  // namespace

const std::vector<std::string_view>& route_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const NamedRoute& route : kRoutes) all.push_back(route.name);
    return all;
  }();
  return names;
}

Result<Route> find_route(std::string_view name) { return internal::make_named(kRoutes, name, "route"); }

std::vector<VehicleState> drive(const Route& route, double rate_hz, const DrivingLimits& limits) {
  GS_CHECK(rate_hz > 0.0, "a frame rate");
  constexpr double kSpacingM = 0.05;
  const std::vector<double> speeds = speed_limits(route, kSpacingM, limits);
  // Each interval is driven at an even acceleration, so that it takes 2 ds / (v0 + v1); halts take their time.
  std::vector<VehicleState> states;
  double begin_s = 0.0;
  int frame = 0;
  for (std::size_t k = 0; k + 1 < speeds.size(); ++k) {
    const double from_m = static_cast<double>(k) * kSpacingM;
    if (speeds[k] == 0.0) {
      for (; frame / rate_hz < begin_s + route.stop_s; ++frame) states.push_back({frame / rate_hz, from_m, 0.0, 0.0});
      begin_s += route.stop_s;
    }
    const double duration_s = 2.0 * kSpacingM / (speeds[k] + speeds[k + 1]);
    const double acceleration = (speeds[k + 1] - speeds[k]) / duration_s;
    for (; frame / rate_hz < begin_s + duration_s; ++frame) {
      const double t = frame / rate_hz - begin_s;
      states.push_back({frame / rate_hz, from_m + speeds[k] * t + 0.5 * acceleration * t * t,
                        speeds[k] + acceleration * t, acceleration});
    }
    begin_s += duration_s;
  }
  return states;
}

}  // namespace groundscale
