#include "groundscale/scale/speed_reference.hpp"

#include <algorithm>
#include <cmath>

#include "groundscale/core/check.hpp"
#include "groundscale/estimation/robust.hpp"

namespace groundscale {
namespace {

constexpr std::size_t kFewCompared = 5;
constexpr std::size_t kLatestCompared = 50;

}  // namespace

void visit_fields(SpeedReferenceOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "speed",
                 .unit = "",
                 .help = "speed log (CSV with time_s,speed_mps, or .gpx) that gives the scale where no ground is seen; "
                         "\"\" is none"},
                options.file);
  visitor.field({.key = "speed_offset_s", .unit = "s", .help = "by how much its clock is ahead of the video's"},
                options.offset_s);
  visitor.field({.key = "speed_sd_mps", .unit = "m/s", .help = "sd of its speeds", .min = 0.01, .max = 10},
                options.sd_mps);
}

bool is_gross(double off, double held_sd, const LoggedStep& logged) {
  constexpr double kSigmas = 3.0;
  return !(std::abs(off) <= std::max(kGrossLogRatio, kSigmas * std::hypot(held_sd, logged.log_sd)));
}

std::optional<LoggedStep> SpeedReference::step(double from_s, double to_s) const {
  constexpr double kMinSpeedMps = 1.5;
  constexpr double kModelSd = 0.01;
  constexpr double kAlikeS = 1.0;
  if (!(to_s > from_s)) return std::nullopt;
  const auto distance_m = log_.distance_m(from_s + options_.offset_s, to_s + options_.offset_s);
  if (!distance_m) return std::nullopt;
  const double speed_mps = *distance_m / (to_s - from_s);
  if (!(speed_mps >= kMinSpeedMps)) return std::nullopt;
  const double share = std::min(1.0, (to_s - from_s) / std::max(kAlikeS, log_.median_interval_s()));
  return LoggedStep{*distance_m, std::hypot(options_.sd_mps / speed_mps, kModelSd) / std::sqrt(share)};
}

void SpeedReference::compare(const LoggedStep& logged, double ground_m) {
  GS_CHECK(logged.distance_m > 0.0 && ground_m > 0.0, "both moved");
  log_ratios_.push_back(std::log(logged.distance_m / ground_m));
}

bool SpeedReference::agrees() const {
  if (log_ratios_.size() < kFewCompared) return true;
  const auto latest = static_cast<std::ptrdiff_t>(std::min(log_ratios_.size(), kLatestCompared));
  return std::abs(median({log_ratios_.end() - latest, log_ratios_.end()})) <= kGrossLogRatio;
}

std::optional<double> SpeedReference::ratio() const {
  if (log_ratios_.size() < kFewCompared) return std::nullopt;
  return std::exp(median(log_ratios_));
}

}  // namespace groundscale
