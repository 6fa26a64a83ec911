#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "groundscale/core/options.hpp"
#include "groundscale/geometry/speed_log.hpp"

namespace groundscale {

struct SpeedReferenceOptions {
  std::string file;       ///< CSV with time_s,speed_mps, or GPX track; "": none.
  double offset_s = 0.0;  ///< By how much the log's clock is ahead of the video's.
  double sd_mps = 0.2;    ///< Of a speed in the log.
};

/// Keys `speed`, `speed_offset_s`, `speed_sd_mps`.
void visit_fields(SpeedReferenceOptions& options, FieldVisitor& visitor);

/// What a speed log says of the way from one frame to the next.
struct LoggedStep {
  double distance_m = 0.0;
  double log_sd = 0.0;  ///< Sd of log distance that it counts with, as one of many steps.
};

/// Two scales that differ by more, as a logarithm, aren't noise: a unit, a clock or a map is wrong.
inline constexpr double kGrossLogRatio = 0.2;

/// Whether a log's step is too far from what is held to be an observation of it: beyond kGrossLogRatio and beyond three
/// sd of both together. So where nothing else has come for long, and little is known, more is let in.
/// @param off      Log of one scale over the other.
/// @param held_sd  Sd of the log of what is held.
bool is_gross(double off, double held_sd, const LoggedStep& logged);

/// A speed log as what stands in where no ground is seen, and how it agrees with the ground where there is one.
class SpeedReference {
 public:
  SpeedReference(SpeedLog log, const SpeedReferenceOptions& options) : log_(std::move(log)), options_(options) {}

  /// The way between two times by the video's clock, where the log knows all of it and its mean speed v is at least
  /// 1.5 m/s. A step dt of a log with interval T counts with
  ///   var log distance = ((sd_mps / v)^2 + 0.01^2) / min(1, dt / max(T, 1 s)),
  /// because speeds between two rows have the errors of these rows, and those of neighbouring rows of a fast log are
  /// alike: all steps of a second together count as one speed, whatever the frame rate. 0.01 is for tyres, and for an
  /// antenna that takes a turn on another radius.
  std::optional<LoggedStep> step(double from_s, double to_s) const;

  /// A step whose length an accepted measurement of the ground knows, > 0.
  void compare(const LoggedStep& logged, double ground_m);
  /// False where the log's steps have been off the ground's by more than kGrossLogRatio, in the median of the latest 50
  /// compared; true before there are 5.
  bool agrees() const;
  /// Log's over ground's steps, median of all compared; nothing before there are 5.
  std::optional<double> ratio() const;
  int compared() const { return static_cast<int>(log_ratios_.size()); }

  const SpeedLog& log() const { return log_; }
  const SpeedReferenceOptions& options() const { return options_; }

 private:
  SpeedLog log_;
  SpeedReferenceOptions options_;
  std::vector<double> log_ratios_;
};

}  // namespace groundscale
