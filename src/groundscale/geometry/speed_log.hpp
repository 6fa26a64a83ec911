#pragma once

#include <optional>
#include <vector>

#include "groundscale/core/result.hpp"

namespace groundscale {

/// A vehicle's speed at a time, by the clock of whoever wrote it down.
struct SpeedSample {
  double time_s = 0.0;
  double speed_mps = 0.0;
  bool after_gap = false;  ///< Nothing is known between the sample before and this one, however close they are.
};

/// No road vehicle is faster; the speeds of a log in km/h often are.
inline constexpr double kMaxSpeedMps = 100.0;

/// Whether a sample may follow `before` (null: it is the first): finite, 0 to kMaxSpeedMps, later.
/// @return kBadInput, without the sample's place.
Result<void> check_sample(const SpeedSample* before, const SpeedSample& sample);

/// A unit that a log may have instead of m/s.
struct SpeedUnit {
  const char* name;
  double per_mps;
};
/// The one that a log is likely in whose speeds are `ratio` (> 0) times the true ones: km/h, mph or feet a second, the
/// nearest within 12 %; null where there is none.
const SpeedUnit* likely_unit(double ratio);

/// Speeds over time, as a vehicle's bus or a satellite receiver gives them. Between samples speed is linear; gaps are
/// not interpolated over. A gap is an interval of more than two and a half median ones, though 0.5 s never is one and
/// more than 5 s always.
class SpeedLog {
 public:
  /// @return kBadInput for samples that check_sample refuses (with their number, from 1), fewer than 5 of them, or
  /// samples
  ///         that are 5 s apart or more.
  static Result<SpeedLog> create(std::vector<SpeedSample> samples);

  const std::vector<SpeedSample>& samples() const { return samples_; }
  double first_s() const { return samples_.front().time_s; }
  double last_s() const { return samples_.back().time_s; }
  double median_interval_s() const { return median_interval_s_; }

  /// Nothing before the first, after the last and inside a gap.
  std::optional<double> speed_at(double time_s) const;
  /// The way between two times, the integral of speed; nothing where any of it isn't known.
  std::optional<double> distance_m(double from_s, double to_s) const;

  struct Gap {
    double from_s = 0.0;
    double to_s = 0.0;
  };
  std::vector<Gap> gaps() const;

  /// Whether nothing is known between sample `index` - 1 and sample `index`.
  bool is_gap(std::size_t index) const;

 private:
  SpeedLog(std::vector<SpeedSample> samples, double median_interval_s);
  /// Sample that ends the interval in which a time lies; 0 where there is none.
  std::size_t interval_of(double time_s) const;

  std::vector<SpeedSample> samples_;
  double median_interval_s_;
  double max_interval_s_;
  std::vector<double> way_m_;  ///< From the first sample to each one, gaps counting as nothing.
  std::vector<int> gaps_;      ///< Gaps up to each one.
};

}  // namespace groundscale
