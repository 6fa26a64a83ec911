#include "groundscale/report/sample_frames.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <system_error>

#include <fmt/format.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/report/overlay.hpp"

namespace groundscale {
namespace {

constexpr std::size_t kShown = 8;
constexpr std::size_t kWorstShown = 3;
constexpr std::size_t kRefusedShown = 2;
constexpr std::size_t kWorstKept = 4;
constexpr std::size_t kRefusalsKept = 6;
constexpr double kWorseBy = 1.1;
constexpr int kPictureWidthPx = 960;
constexpr double kLeastTrueStepM = 0.2;  // as evaluate counts moving steps
constexpr double kMostError = 3.0;       // of a logarithm: a step of 1/20 or 20 times its length

/// How far off a frame is, and in which sense.
std::optional<SampleFrame> badness_of(const FrameResult& result, std::optional<double> true_step_m) {
  SampleFrame sample{.frame = result.frame, .why = "", .value = 0.0, .picture = ""};
  if (!result.scaled) return std::nullopt;
  if (true_step_m) {
    if (!(*true_step_m >= kLeastTrueStepM)) return std::nullopt;
    const double error = std::abs(std::log(result.online_step_m / *true_step_m));
    sample.why = "error";
    sample.value = std::isfinite(error) ? std::min(error, kMostError) : kMostError;
    return sample;
  }
  const double sd = std::hypot(result.raw_sd, result.online_step_sd);
  if (!result.raw_over_online || !(*result.raw_over_online > 0.0) || !(sd > 0.0)) return std::nullopt;
  sample.why = "deviation";
  sample.value = std::abs(std::log(*result.raw_over_online)) / sd;
  return sample;
}

using Candidate = SampleFrames::Candidate;

bool worse(const Candidate& a, const Candidate& b) { return a.sample.value > b.sample.value; }

bool holds(const std::vector<Candidate>& candidates, int frame) {
  return std::any_of(candidates.begin(), candidates.end(),
                     [frame](const Candidate& candidate) { return candidate.sample.frame == frame; });
}

/// Of the candidates the one that lies farthest from all that are chosen; nothing where all are among them.
const Candidate* farthest(const std::vector<Candidate>& candidates, const std::vector<Candidate>& chosen) {
  const Candidate* best = nullptr;
  int best_gap = 0;
  for (const Candidate& candidate : candidates) {
    int gap = std::numeric_limits<int>::max();
    for (const Candidate& other : chosen) gap = std::min(gap, std::abs(candidate.sample.frame - other.sample.frame));
    if (gap > best_gap) {
      best = &candidate;
      best_gap = gap;
    }
  }
  return best;
}

std::string picture_name(int frame) { return fmt::format("{:06}.jpg", frame); }

}  // namespace

void SampleFrames::take(const Frame& frame, const Odometry& odometry, const Camera& camera,
                        std::optional<double> true_step_m) {
  take(odometry.results().back(), true_step_m, [&]() -> DrawPicture {
    return [parts = overlay_parts(frame, odometry, camera, kPictureWidthPx)] { return overlay_jpeg(parts); };
  });
}

void SampleFrames::take(const FrameResult& result, std::optional<double> true_step_m, const PutAside& put_aside) {
  DrawPicture draw;  // put aside once, though it may be wanted in several places
  const auto once = [&] {
    if (!draw) draw = put_aside();
    return draw;
  };
  take_worst(result, true_step_m, once);
  take_refused(result, once);
  take_spread(result, once);
  ++taken_;
}

void SampleFrames::take_worst(const FrameResult& result, std::optional<double> true_step_m, const PutAside& put_aside) {
  const std::optional<SampleFrame> sample = badness_of(result, true_step_m);
  if (!sample) return;
  const int apart = std::max(5, frames_ / 50);
  const auto neighbour = std::find_if(worst_.begin(), worst_.end(), [&](const Candidate& other) {
    return std::abs(other.sample.frame - sample->frame) < apart;
  });
  auto place = neighbour;
  if (place == worst_.end() && worst_.size() == kWorstKept) {
    place = std::max_element(worst_.begin(), worst_.end(), worse);  // the least bad
  }
  if (place == worst_.end()) {
    worst_.push_back({*sample, put_aside()});
  } else if (sample->value >= kWorseBy * place->sample.value) {
    *place = {*sample, put_aside()};
  }
}

void SampleFrames::take_refused(const FrameResult& result, const PutAside& put_aside) {
  const bool drove =
      result.state == FrameState::kMoving || result.state == FrameState::kBridged || result.state == FrameState::kLost;
  if (!drove || result.reason.empty() || taken_ == 0) return;
  const std::string kind = kind_of_reason(result.reason);
  const auto found = refused_.find(kind);
  if (found == refused_.end() && refused_.size() >= kRefusalsKept) return;
  Refusals& refusals = refused_[kind];
  ++refusals.count;
  // The second of a kind: the first ones often belong to the start of the drive.
  if (refusals.count > 2) return;
  refusals.shown = {{.frame = result.frame, .why = "refused", .value = 0.0, .picture = ""}, put_aside()};
}

void SampleFrames::take_spread(const FrameResult& result, const PutAside& put_aside) {
  if (spread_.size() >= kShown) return;
  const double wanted = (static_cast<double>(spread_.size()) + 0.5) * frames_ / static_cast<double>(kShown);
  if (taken_ < static_cast<int>(wanted)) return;
  spread_.push_back({{.frame = result.frame, .why = "spread", .value = 0.0, .picture = ""}, put_aside()});
}

std::vector<SampleFrame> SampleFrames::chosen() const {
  std::vector<Candidate> chosen;
  const auto add = [&chosen](const Candidate& candidate) {
    if (chosen.size() < kShown && !holds(chosen, candidate.sample.frame)) chosen.push_back(candidate);
  };
  std::vector<Candidate> worst = worst_;
  std::stable_sort(worst.begin(), worst.end(), worse);
  for (std::size_t k = 0; k < std::min(kWorstShown, worst.size()); ++k) add(worst[k]);
  std::vector<const Refusals*> refused;
  for (const auto& [kind, refusals] : refused_) refused.push_back(&refusals);
  std::stable_sort(refused.begin(), refused.end(),
                   [](const Refusals* a, const Refusals* b) { return a->count > b->count; });
  for (std::size_t k = 0; k < std::min(kRefusedShown, refused.size()); ++k) add(refused[k]->shown);
  while (chosen.size() < kShown) {
    const Candidate* next = farthest(spread_, chosen);
    if (next == nullptr) break;
    chosen.push_back(*next);
  }
  for (const Candidate& candidate : worst) add(candidate);
  for (const Refusals* refusals : refused) add(refusals->shown);
  std::sort(chosen.begin(), chosen.end(),
            [](const Candidate& a, const Candidate& b) { return a.sample.frame < b.sample.frame; });
  std::vector<SampleFrame> samples;
  for (const Candidate& candidate : chosen) {
    samples.push_back(candidate.sample);
    samples.back().picture = candidate.draw();
  }
  return samples;
}

std::string kind_of_reason(std::string_view reason) {
  std::string kind;
  for (std::size_t k = 0; k < reason.size();) {
    const auto is_digit = [&](std::size_t j) {
      return j < reason.size() && std::isdigit(static_cast<unsigned char>(reason[j])) != 0;
    };
    const bool after_letter = k > 0 && std::isalnum(static_cast<unsigned char>(reason[k - 1])) != 0;
    const std::size_t sign = !after_letter && (reason[k] == '-' || reason[k] == '+') && is_digit(k + 1) ? 1 : 0;
    if (after_letter || !is_digit(k + sign)) {
      kind += reason[k++];
      continue;
    }
    k += sign;
    while (is_digit(k) || (k < reason.size() && reason[k] == '.' && is_digit(k + 1))) ++k;
    kind += "...";
  }
  return kind;
}

Result<void> write_samples(const std::string& folder, const std::vector<SampleFrame>& samples) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::string csv = "frame,why,value,picture\n";
  for (const SampleFrame& sample : samples) {
    if (sample.picture.empty()) continue;
    const std::string name = picture_name(sample.frame);
    if (const auto done = write_text((std::filesystem::path(folder) / name).string(), sample.picture); !done) {
      return done;
    }
    csv += fmt::format("{},{},{},{}\n", sample.frame, sample.why, internal::shortest(sample.value), name);
  }
  return write_text((std::filesystem::path(folder) / "samples.csv").string(), csv);
}

Result<std::vector<SampleFrame>> read_samples(const std::string& folder) {
  const std::string path = (std::filesystem::path(folder) / "samples.csv").string();
  std::error_code ignored;
  std::vector<SampleFrame> samples;
  if (!std::filesystem::exists(path, ignored)) return samples;
  const auto text = read_text(path);
  if (!text) return text.error();
  for (const internal::Line& line : internal::split_lines(*text)) {
    if (line.number == 1 || internal::trimmed(line.text).empty()) continue;
    const std::vector<std::string> fields = internal::csv_fields(line.text);
    const auto frame = internal::parse_integer(fields.front());
    const double value = internal::parse_number(fields.size() == 4 ? fields[2] : "").value_or(-1.0);
    if (!frame || *frame < 0 || *frame > std::numeric_limits<int>::max() || !std::isfinite(value) || value < 0.0) {
      return internal::bad_input(
          fmt::format("{}:{}: must be frame,why,value,picture, as run writes it", path, line.number));
    }
    SampleFrame sample{.frame = static_cast<int>(*frame), .why = fields[1], .value = value, .picture = ""};
    // The name follows from the number: no other file is ever shown.
    const auto picture = read_text((std::filesystem::path(folder) / picture_name(sample.frame)).string());
    if (picture) sample.picture = *picture;
    samples.push_back(std::move(sample));
  }
  return samples;
}

}  // namespace groundscale
