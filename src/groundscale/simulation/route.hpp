#pragma once

#include <string_view>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/simulation/path.hpp"

namespace groundscale {

/// What a route's road is like and what stands beside it.
enum class Surroundings { kTown, kCountry, kMotorway };

/// A road and how fast it is driven.
struct Route {
  Path path;
  Surroundings surroundings = Surroundings::kTown;
  double cruise_mps = 0.0;
  std::vector<double> stops_m;  ///< Distances at which the vehicle halts, ascending.
  double stop_s = 0.0;          ///< How long it waits there.
};

/// Names of the built-in routes, in the order of the docs.
const std::vector<std::string_view>& route_names();

/// @return kBadInput with the list of names where there is none of this one.
Result<Route> find_route(std::string_view name);

/// What a driver does: never faster than the cruise speed, slow enough in turns, ever within what is comfortable.
struct DrivingLimits {
  double lateral_mps2 = 2.0;
  double acceleration_mps2 = 1.5;
  double braking_mps2 = 2.0;
};

/// The vehicle at one moment.
struct VehicleState {
  double time_s = 0.0;
  double distance_m = 0.0;  ///< Along the path.
  double speed_mps = 0.0;
  double acceleration_mps2 = 0.0;
};

/// The vehicle every 1 / `rate_hz` seconds from the path's start to its end. The first state is at cruise speed, or as
/// fast as the first turn and stop allow.
/// @pre rate_hz > 0.
std::vector<VehicleState> drive(const Route& route, double rate_hz, const DrivingLimits& limits);

}  // namespace groundscale
