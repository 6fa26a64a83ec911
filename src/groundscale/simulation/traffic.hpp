#pragma once

#include <cstdint>
#include <vector>

#include "groundscale/simulation/cars.hpp"
#include "groundscale/simulation/road_surface.hpp"
#include "groundscale/simulation/route.hpp"
#include "groundscale/simulation/shapes.hpp"

namespace groundscale {

struct TrafficOptions {
  bool on = false;                ///< Nothing moves but the vehicle where it isn't.
  int ahead = 1;                  ///< Cars in the vehicle's own lane.
  double gap_s = 2.0;             ///< From the vehicle to the one ahead, and on to the next.
  double oncoming_every_s = 8.0;  ///< Mean time between cars that are driven towards the vehicle; 0: none. At least 3.
  double visible_m = 180.0;       ///< Cars further ahead or behind than this along the path aren't made.
  double vehicle_length_m = 4.5;
  double vehicle_half_width_m = 0.9;
};

/// A moving car at one moment.
struct MovingCar {
  CarKind kind = CarKind::kSmall;
  int variant = 0;
  bool oncoming = false;
  double distance_m = 0.0;  ///< Along the driven path.
  Footing foot;             ///< It heads along it.
};

/// Other cars on the road that a vehicle drives along. Those ahead do what the vehicle does `gap_s` later; those that
/// come towards it slow down where it does, but don't halt. Where a path crosses itself, a car that would stand in
/// another or in the vehicle is left out for that moment. The same for a seed; an object of this class never changes.
class Traffic {
 public:
  /// @param surface  Must outlive the object.
  /// @param drive    The vehicle's states by time, at least two.
  Traffic(const RoadSurface& surface, const std::vector<VehicleState>& drive, const TrafficOptions& options,
          std::uint64_t seed);

  /// Where all cars in sight are; those ahead first. O(cars) + O(log states) a car.
  std::vector<MovingCar> cars_at(double time_s) const;
  /// Their shapes; materials' variants don't meet those of parked cars.
  Meshes at(double time_s) const;

 private:
  struct Driver {
    CarKind kind = CarKind::kSmall;
    int variant = 0;
    double time_s = 0.0;  ///< Ahead: so much before the vehicle. Oncoming: see oncoming_distance.
    double aside_m = 0.0;
  };

  double distance_at(double time_s) const;
  double oncoming_distance(const Driver& driver, double time_s) const;
  MovingCar place(const Driver& driver, double distance_m, bool oncoming) const;

  const RoadSurface& surface_;
  TrafficOptions options_;
  std::vector<double> times_s_;  ///< The drive's states.
  std::vector<double> distances_m_;
  std::vector<double> flowing_s_;  ///< Time at each state, halts left out.
  double first_speed_mps_ = 0.0;   ///< Before the drive, and behind its end.
  double last_speed_mps_ = 0.0;
  std::vector<Driver> ahead_;
  std::vector<Driver> oncoming_;
};

}  // namespace groundscale
