#include "groundscale/geometry/speed_log.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

namespace groundscale {
namespace {

constexpr std::size_t kMinSamples = 5;
constexpr double kGapIntervals = 2.5;
constexpr double kNeverGapS = 0.5;
constexpr double kAlwaysGapS = 5.0;

/// As a message has it: without a row of zeros.
std::string text_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

Error bad(std::string message) { return {ErrorCode::kBadInput, std::move(message)}; }

}  // namespace

const SpeedUnit* likely_unit(double ratio) {
  static constexpr std::array<SpeedUnit, 3> kUnits = {{{"km/h", 3.6}, {"mph", 2.2369}, {"feet a second", 3.2808}}};
  constexpr double kNear = 0.12;
  const auto off = [ratio](const SpeedUnit& unit) { return std::abs(std::log(ratio / unit.per_mps)); };
  const auto nearest = std::min_element(kUnits.begin(), kUnits.end(),
                                        [&off](const SpeedUnit& a, const SpeedUnit& b) { return off(a) < off(b); });
  return off(*nearest) <= kNear ? &*nearest : nullptr;
}

Result<void> check_sample(const SpeedSample* before, const SpeedSample& sample) {
  if (!std::isfinite(sample.time_s))
    return bad("the time is " + text_of(sample.time_s) + ", it must be a finite number");
  if (!std::isfinite(sample.speed_mps)) {
    return bad("the speed is " + text_of(sample.speed_mps) + ", it must be a finite number");
  }
  if (sample.speed_mps < 0.0) {
    return bad("the speed is " + text_of(sample.speed_mps) +
               " m/s, it must not be negative (a camera's way has no sign)");
  }
  if (sample.speed_mps > kMaxSpeedMps) {
    return bad("the speed is " + text_of(sample.speed_mps) + " m/s, it must be at most " + text_of(kMaxSpeedMps) +
               " m/s: is it in km/h?");
  }
  if (before != nullptr && !(sample.time_s > before->time_s)) {
    return bad("the time doesn't rise: " + text_of(before->time_s) + " s, then " + text_of(sample.time_s) + " s");
  }
  return {};
}

Result<SpeedLog> SpeedLog::create(std::vector<SpeedSample> samples) {
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const Result<void> checked = check_sample(k > 0 ? &samples[k - 1] : nullptr, samples[k]);
    if (!checked) return bad("sample " + std::to_string(k + 1) + ": " + checked.error().message);
  }
  if (samples.size() < kMinSamples) {
    return bad("the log has " + std::to_string(samples.size()) + " speeds, at least " + std::to_string(kMinSamples) +
               " are needed");
  }
  std::vector<double> intervals_s;
  for (std::size_t k = 1; k < samples.size(); ++k) intervals_s.push_back(samples[k].time_s - samples[k - 1].time_s);
  const auto middle = intervals_s.begin() + static_cast<std::ptrdiff_t>(intervals_s.size() / 2);
  std::nth_element(intervals_s.begin(), middle, intervals_s.end());
  if (*middle >= kAlwaysGapS) {
    return bad("the speeds are " + text_of(*middle) + " s apart, they must be less than " + text_of(kAlwaysGapS) +
               " s apart: what a vehicle did in between isn't guessed");
  }
  return SpeedLog(std::move(samples), *middle);
}

SpeedLog::SpeedLog(std::vector<SpeedSample> samples, double median_interval_s)
    : samples_(std::move(samples)),
      median_interval_s_(median_interval_s),
      max_interval_s_(std::clamp(kGapIntervals * median_interval_s, kNeverGapS, kAlwaysGapS)) {
  way_m_.push_back(0.0);
  gaps_.push_back(0);
  for (std::size_t k = 1; k < samples_.size(); ++k) {
    const double interval_s = samples_[k].time_s - samples_[k - 1].time_s;
    const bool gap = is_gap(k);
    gaps_.push_back(gaps_.back() + (gap ? 1 : 0));
    way_m_.push_back(way_m_.back() +
                     (gap ? 0.0 : 0.5 * interval_s * (samples_[k].speed_mps + samples_[k - 1].speed_mps)));
  }
}

bool SpeedLog::is_gap(std::size_t index) const {
  GS_CHECK(index > 0 && index < samples_.size(), "a sample that has one before it");
  return samples_[index].after_gap || samples_[index].time_s - samples_[index - 1].time_s > max_interval_s_;
}

std::size_t SpeedLog::interval_of(double time_s) const {
  if (!(time_s >= first_s() && time_s <= last_s())) return 0;
  const auto above = std::upper_bound(samples_.begin(), samples_.end(), time_s,
                                      [](double time, const SpeedSample& sample) { return time < sample.time_s; });
  return std::min(static_cast<std::size_t>(above - samples_.begin()), samples_.size() - 1);
}

std::optional<double> SpeedLog::speed_at(double time_s) const {
  const std::size_t end = interval_of(time_s);
  if (end == 0) return std::nullopt;
  const SpeedSample& a = samples_[end - 1];
  const SpeedSample& b = samples_[end];
  if (time_s == a.time_s) return a.speed_mps;
  if (time_s == b.time_s) return b.speed_mps;
  if (is_gap(end)) return std::nullopt;
  return a.speed_mps + (b.speed_mps - a.speed_mps) * (time_s - a.time_s) / (b.time_s - a.time_s);
}

std::optional<double> SpeedLog::distance_m(double from_s, double to_s) const {
  GS_CHECK(from_s <= to_s, "from comes before to");
  const std::optional<double> from_mps = speed_at(from_s);
  const std::optional<double> to_mps = speed_at(to_s);
  if (!from_mps || !to_mps) return std::nullopt;
  const std::size_t from = interval_of(from_s);  // the interval that from_s lies in or begins,
  std::size_t to = interval_of(to_s);
  if (to_s == samples_[to - 1].time_s && to > from) --to;  // and that to_s lies in or ends
  if (gaps_[to] != gaps_[from - 1] && from_s != to_s) return std::nullopt;
  const auto way_to = [this](std::size_t end, double time_s, double speed_mps) {
    const SpeedSample& a = samples_[end - 1];
    return way_m_[end - 1] + 0.5 * (time_s - a.time_s) * (a.speed_mps + speed_mps);
  };
  return way_to(to, to_s, *to_mps) - way_to(from, from_s, *from_mps);
}

std::vector<SpeedLog::Gap> SpeedLog::gaps() const {
  std::vector<Gap> gaps;
  for (std::size_t k = 1; k < samples_.size(); ++k) {
    if (is_gap(k)) gaps.push_back({samples_[k - 1].time_s, samples_[k].time_s});
  }
  return gaps;
}

}  // namespace groundscale
