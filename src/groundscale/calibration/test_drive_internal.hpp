#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "groundscale/calibration/odometer.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/geometry/speed_log.hpp"

namespace groundscale::internal {

/// For tests: a drive of which the speed is known at every time, what an odometry makes of it, and what is written down
/// on the way.
struct TestDrive {
  double duration_s = 120.0;
  std::function<double(double)> speed_mps = town_speed;
  double ratio = 1.1;        ///< True lengths over the odometry's.
  double step_noise = 0.01;  ///< Of each step of the odometry, relative.
  double log_noise_mps = 0.2;
  double log_interval_s = 1.0;
  double clock_ahead_s = 3.0;  ///< Of the log.
  double log_starts_s = 0.3;   ///< By the video's clock.
  double log_ends_s = 1e9;

  /// As in a town: turns at 4 m/s, straights at up to 13 m/s, a stop now and then.
  static double town_speed(double time_s) {
    const double wave = 8.5 + 3.0 * std::sin(0.21 * time_s) + 1.5 * std::sin(0.53 * time_s + 1.0);
    const double since_stop = std::fmod(time_s + 10.0, 50.0);
    const double stop = since_stop < 4.0 ? 0.0 : std::min(1.0, (since_stop - 4.0) / 5.0);
    const double slowing = std::min(1.0, (50.0 - since_stop) / 5.0);
    return wave * stop * slowing;
  }

  /// The true way between two times, by Simpson's rule over pieces of 0.05 s and less.
  double way_m(double from_s, double to_s) const {
    const int pieces = static_cast<int>(std::ceil((to_s - from_s) / 0.05));
    const double h = (to_s - from_s) / pieces;
    double way = 0.0;
    for (int k = 0; k < pieces; ++k) {
      const double a = from_s + k * h;
      way += h / 6.0 * (speed_mps(a) + 4.0 * speed_mps(a + 0.5 * h) + speed_mps(a + h));
    }
    return way;
  }

  std::vector<double> times_s() const {
    std::vector<double> times;
    for (int k = 0; 0.1 * k <= duration_s + 1e-9; ++k) times.push_back(0.1 * k);
    return times;
  }

  Odometer odometer(Rng& rng) const {
    const std::vector<double> times = times_s();
    std::vector<std::optional<double>> steps = {0.0};
    for (std::size_t k = 1; k < times.size(); ++k) {
      steps.emplace_back(way_m(times[k - 1], times[k]) / ratio * std::exp(step_noise * rng.normal()));
    }
    return Odometer(times, steps);
  }

  std::vector<SpeedSample> samples(Rng& rng) const {
    std::vector<SpeedSample> samples;
    for (double t = log_starts_s; t <= std::min(duration_s, log_ends_s); t += log_interval_s) {
      samples.push_back({t + clock_ahead_s, std::max(0.0, speed_mps(t) + log_noise_mps * rng.normal())});
    }
    return samples;
  }
  SpeedLog log(Rng& rng) const { return SpeedLog::create(samples(rng)).value(); }
};

}  // namespace groundscale::internal
