#include "groundscale/odometry/speed_check.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

namespace groundscale {
namespace {

/// Where the log lies by the video's clock, beside the drive.
std::string beside(const SpeedReference& speed, const TimeSpan& drive) {
  const double offset_s = speed.options().offset_s;
  return fmt::format(
      "it goes from {:.1f} to {:.1f} s by the video's clock, the drive from {:.1f} to {:.1f} s (scale.speed_offset_s, "
      "by "
      "how much the log's clock is ahead, is {:g})",
      speed.log().first_s() - offset_s, speed.log().last_s() - offset_s, drive.first_s, drive.last_s, offset_s);
}

bool overlaps(const SpeedReference& speed, const TimeSpan& drive) {
  const double offset_s = speed.options().offset_s;
  return speed.log().first_s() < drive.last_s + offset_s && speed.log().last_s() > drive.first_s + offset_s;
}

/// Frames of which the log doesn't know how far they are from the ones before.
std::string unknown_frames(const SpeedReference& speed, const std::vector<FrameResult>& results) {
  const double offset_s = speed.options().offset_s;
  const TimeSpan drive{results.front().time_s, results.back().time_s};
  if (!overlaps(speed, drive)) return "scale.speed: the log doesn't overlap the drive: " + beside(speed, drive);
  int unknown = 0;
  for (std::size_t k = 1; k < results.size(); ++k) {
    const double from_s = results[k - 1].time_s + offset_s;
    if (!speed.log().distance_m(from_s, results[k].time_s + offset_s)) ++unknown;
  }
  if (unknown == 0) return {};
  std::string text = fmt::format("scale.speed: the log knows nothing of {} of {} frames", unknown, results.size() - 1);
  const auto gaps = speed.log().gaps();
  const auto inside = [&](const SpeedLog::Gap& gap) {
    return gap.from_s < drive.last_s + offset_s && gap.to_s > drive.first_s + offset_s;
  };
  const auto first = std::find_if(gaps.begin(), gaps.end(), inside);
  if (first == gaps.end()) return text + ": " + beside(speed, drive);
  return text + fmt::format("; the first of {} gaps in the drive is from {:.1f} to {:.1f} s by the video's clock",
                            std::count_if(gaps.begin(), gaps.end(), inside), first->from_s - offset_s,
                            first->to_s - offset_s);
}

/// How the log's speeds and those by the ground differ, beyond what a few noisy ones may.
std::string disagreement(double ratio, int compared) {
  constexpr double kMuch = 0.05;
  constexpr int kEnough = 50;
  const double off = std::log(ratio);
  if (std::abs(off) <= kMuch) return {};
  if (std::abs(off) <= kGrossLogRatio) {
    if (compared < kEnough) return {};
    return fmt::format(
        "scale.speed: the log's speeds are {:.1f} % {} those by the ground; which of them is right, log or camera "
        "height, isn't known from this (groundscale height compares them)",
        100.0 * std::abs(ratio - 1.0), off > 0.0 ? "above" : "below");
  }
  std::string text = fmt::format(
      "scale.speed: the log's speeds are {:.2f} times those by the ground, and aren't used where they differ so much",
      ratio);
  const SpeedUnit* unit = likely_unit(ratio);
  return text + (unit != nullptr ? fmt::format("; are they in {}? m/s are needed", unit->name)
                                 : "; is the log of this drive, and scale.speed_offset_s right?");
}

}  // namespace

Result<void> check_overlap(const SpeedReference& speed, const TimeSpan& drive) {
  if (overlaps(speed, drive)) return {};
  return Error{ErrorCode::kBadInput, fmt::format("scale.speed: {}: the log doesn't overlap the drive: {}",
                                                 speed.options().file, beside(speed, drive))};
}

std::vector<std::string> speed_warnings(const SpeedReference& speed, const std::vector<FrameResult>& results) {
  std::vector<std::string> warnings;
  if (results.empty()) return warnings;
  if (const std::string text = unknown_frames(speed, results); !text.empty()) warnings.push_back(text);
  if (const std::optional<double> ratio = speed.ratio()) {
    if (const std::string text = disagreement(*ratio, speed.compared()); !text.empty()) warnings.push_back(text);
  }
  const bool measured = std::any_of(results.begin(), results.end(), [](const FrameResult& r) { return r.accepted(); });
  if (!measured && results.back().scaled) {
    warnings.emplace_back("no measurement of the road was accepted: the scale is the speed log's alone");
  }
  return warnings;
}

}  // namespace groundscale
