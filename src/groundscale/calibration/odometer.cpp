#include "groundscale/calibration/odometer.hpp"

#include <algorithm>
#include <utility>

#include "groundscale/core/check.hpp"
#include "groundscale/estimation/robust.hpp"

namespace groundscale {
namespace {

std::vector<std::optional<double>> steps_of(const std::vector<FrameResult>& results) {
  std::vector<std::optional<double>> steps_m;
  for (const FrameResult& result : results) {
    const bool measured = result.state != FrameState::kBridged && result.state != FrameState::kLost && result.scaled;
    steps_m.push_back(measured ? std::optional<double>(result.step_m) : std::nullopt);
  }
  return steps_m;
}

}  // namespace

Odometer::Odometer(const std::vector<FrameResult>& results) {
  for (const FrameResult& result : results) times_s_.push_back(result.time_s);
  take(steps_of(results));
}

Odometer::Odometer(std::vector<double> times_s, const std::vector<std::optional<double>>& steps_m)
    : times_s_(std::move(times_s)) {
  take(steps_m);
}

void Odometer::take(const std::vector<std::optional<double>>& steps_m) {
  GS_CHECK(times_s_.size() == steps_m.size() && times_s_.size() >= 2, "a step a frame, two frames or more");
  way_m_.push_back(0.0);
  unknown_s_.push_back(0.0);
  std::vector<double> intervals_s;
  for (std::size_t k = 1; k < steps_m.size(); ++k) {
    const double interval_s = times_s_[k] - times_s_[k - 1];
    GS_CHECK(interval_s >= 0.0, "times never fall");
    intervals_s.push_back(interval_s);
    way_m_.push_back(way_m_.back() + steps_m[k].value_or(0.0));
    unknown_s_.push_back(unknown_s_.back() + (steps_m[k] ? 0.0 : interval_s));
  }
  median_interval_s_ = median(std::move(intervals_s));
}

std::size_t Odometer::interval_of(double time_s) const {
  const auto above = std::upper_bound(times_s_.begin(), times_s_.end(), time_s);
  const auto index = above == times_s_.begin() ? 0 : static_cast<std::size_t>(above - times_s_.begin()) - 1;
  return std::min(index, times_s_.size() - 2);
}

double Odometer::between(const std::vector<double>& sums, double time_s) const {
  const std::size_t k = interval_of(time_s);
  const double interval_s = times_s_[k + 1] - times_s_[k];
  const double part = interval_s > 0.0 ? std::clamp((time_s - times_s_[k]) / interval_s, 0.0, 1.0) : 1.0;
  return sums[k] + part * (sums[k + 1] - sums[k]);
}

std::optional<double> Odometer::distance_m(double from_s, double to_s) const {
  constexpr double kRounding_s = 1e-9;
  if (from_s < first_s() || to_s > last_s() || unknown_s(from_s, to_s) > kRounding_s) return std::nullopt;
  return between(way_m_, to_s) - between(way_m_, from_s);
}

double Odometer::unknown_s(double from_s, double to_s) const {
  return between(unknown_s_, to_s) - between(unknown_s_, from_s);
}

}  // namespace groundscale
