#pragma once

#include <optional>
#include <vector>

#include "groundscale/odometry/frame_result.hpp"

namespace groundscale {

/// The way driven over time, as the odometry has it; metres at the camera height that it was given.
class Odometer {
 public:
  /// Of a finished drive: final steps. What was bridged, lost or has no scale isn't known.
  explicit Odometer(const std::vector<FrameResult>& results);

  /// @param times_s  Of frames, never falling; two or more.
  /// @param steps_m  From the frame before to each one, none to the first; nothing where it isn't known.
  Odometer(std::vector<double> times_s, const std::vector<std::optional<double>>& steps_m);

  double first_s() const { return times_s_.front(); }
  double last_s() const { return times_s_.back(); }
  double median_interval_s() const { return median_interval_s_; }
  /// Of all known steps.
  double length_m() const { return way_m_.back(); }

  /// The way between two times, linear between frames; nothing where any of it isn't known or lies outside.
  std::optional<double> distance_m(double from_s, double to_s) const;
  /// Time between two times whose steps aren't known.
  double unknown_s(double from_s, double to_s) const;

 private:
  void take(const std::vector<std::optional<double>>& steps_m);
  /// Index of the last frame that isn't later, but never the last one.
  std::size_t interval_of(double time_s) const;
  double between(const std::vector<double>& sums, double time_s) const;

  std::vector<double> times_s_;
  std::vector<double> way_m_;      ///< Up to each frame.
  std::vector<double> unknown_s_;  ///< Time of unknown steps up to each frame.
  double median_interval_s_ = 0.0;
};

}  // namespace groundscale
