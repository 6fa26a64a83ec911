#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <system_error>

#include <fmt/format.h>

#include "groundscale/report/markup_internal.hpp"
#include "groundscale/report/page_internal.hpp"
#include "groundscale/report/run_parts_internal.hpp"
#include "groundscale/report/sample_frames.hpp"

namespace groundscale::internal {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::string_view class_of(Grade grade) {
  switch (grade) {
    case Grade::kGood:
    case Grade::kNote:
      return "verdict good";
    case Grade::kReservation:
      return "verdict";
    case Grade::kBad:
      return "verdict bad";
  }
  return "verdict";
}

/// Says in words what colour would: it must be readable in grey.
std::string_view word_of(Grade grade) {
  switch (grade) {
    case Grade::kGood:
      return "Good";
    case Grade::kNote:
      return "Note";
    case Grade::kReservation:
      return "Reservation";
    case Grade::kBad:
      return "Bad";
  }
  return "";
}

std::vector<std::string> parts_of(const std::string& folder) {
  std::error_code ignored;
  std::vector<std::string> parts;
  for (const auto& part : std::filesystem::absolute(folder, ignored).lexically_normal()) {
    if (!part.empty() && part != ".") parts.push_back(part.string());
  }
  return parts;
}

std::string last_parts(const std::vector<std::string>& parts, std::size_t count) {
  std::string name;
  for (std::size_t k = parts.size() - std::min(count, parts.size()); k < parts.size(); ++k) {
    name += (name.empty() || name == "/" ? "" : "/") + parts[k];
  }
  return name;
}

std::string why_shown(const SampleFrame& sample) {
  if (sample.why == "error") {
    return fmt::format("among the worst: step {:.1f} % off the truth", 100.0 * std::expm1(sample.value));
  }
  if (sample.why == "deviation") {
    return fmt::format("among the worst: measurement {:.1f} sd off the filtered step", sample.value);
  }
  return sample.why == "refused" ? "refused" : "";
}

std::string sample_caption(const SampleFrame& sample, const RunFolder& run) {
  std::string text = fmt::format("Frame {}", sample.frame);
  const std::string why = why_shown(sample);
  if (!why.empty()) text += ", " + why;
  const auto row =
      std::find_if(run.frames.begin(), run.frames.end(), [&](const FrameRow& r) { return r.frame == sample.frame; });
  if (row == run.frames.end()) return text;
  text += ": " + row->state;
  if (row->online_step_m) text += fmt::format(", step {:.3f} m", *row->online_step_m);
  if (row->raw_step_m) text += fmt::format(", raw {:.3f} m", *row->raw_step_m);
  if (row->pitch_deg && row->roll_deg) {
    text += fmt::format(", pitch {:.2f}, roll {:.2f} degrees", *row->pitch_deg, *row->roll_deg);
  }
  if (row->road_matches) {
    text += fmt::format(", {:.0f} of {:.0f} road points fit", row->road_inliers.value_or(0.0), *row->road_matches);
  }
  if (!row->reason.empty()) text += "; " + row->reason;
  return text;
}

std::vector<std::string> counts_alone(const std::vector<std::pair<int, std::string>>& counts) {
  std::vector<std::string> cells;
  for (const auto& [count, name] : counts) cells.push_back(fmt::to_string(count));
  return cells;
}

/// The sum, and who has how much of it, the largest first.
std::vector<std::string> counts_in_words(std::vector<std::pair<int, std::string>> counts) {
  std::stable_sort(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  int sum = 0;
  std::string words;
  for (const auto& [count, name] : counts) {
    if (count == 0) break;
    sum += count;
    words += fmt::format("{}{} {}", words.empty() ? "" : ", ", name, count);
  }
  return {fmt::to_string(sum), words};
}

}  // namespace

std::string verdict_html(const RunVerdict& verdict) {
  std::string html = fmt::format("<p class=\"{}\">{}</p>\n<ul class=\"findings\">\n", class_of(verdict.grade),
                                 escape_html(verdict.words));
  for (const Finding& finding : verdict.findings) {
    html += fmt::format("<li><b>{}.</b> {}</li>\n", word_of(finding.grade), escape_html(finding.words));
  }
  return html + "</ul>\n";
}

std::vector<ReasonCount> reasons_of(const RunFolder& run) {
  std::vector<ReasonCount> reasons;
  for (const FrameRow& row : run.frames) {
    if (row.reason.empty()) continue;
    const std::string kind = kind_of_reason(row.reason);
    const auto found =
        std::find_if(reasons.begin(), reasons.end(), [&](const ReasonCount& reason) { return reason.kind == kind; });
    if (found != reasons.end()) {
      ++found->count;
    } else {
      reasons.push_back({kind, 1, row.frame});
    }
  }
  std::stable_sort(reasons.begin(), reasons.end(),
                   [](const ReasonCount& a, const ReasonCount& b) { return a.count > b.count; });
  return reasons;
}

std::string facts_html(const RunFolder& run) {
  const RunSummary& s = run.summary;
  std::vector<std::pair<std::string, std::string>> pairs = {
      {"drive", run.drive},
      {"frames", fmt::format("{} to {}: {} moving, {} still, {} turning in place, {} bridged, {} lost", s.first_frame,
                             s.first_frame + s.frames - 1, s.moving, s.still, s.rotating, s.bridged, s.lost)},
      {"length", fmt::format("{:.1f} m", s.length_m)},
      {"camera", s.camera_from},
      {"camera height", fmt::format("{:.3f} m, from {}", s.camera_height_m, s.camera_height_from)},
      {"mounting", fmt::format("pitch {:.2f}, roll {:.2f}, yaw {:.2f} degrees", s.mounting.pitch_rad / kDegree,
                               s.mounting.roll_rad / kDegree, s.mounting.yaw_rad / kDegree)}};
  if (!run.truth.empty()) pairs.emplace_back("truth", run.truth);
  if (s.speed_log) {
    pairs.emplace_back("speed log", fmt::format("{}: {} frames scaled by it", s.speed_log->file, s.speed_log->scaled));
  }
  pairs.emplace_back("seed", fmt::to_string(s.seed));
  pairs.emplace_back("made by", "groundscale " + s.version);
  return definitions(pairs);
}

std::string settings_html(const RunFolder& run) {
  if (run.settings.empty()) {
    return run.config_text.empty() ? "" : details("config.yaml", "<pre>" + escape_html(run.config_text) + "</pre>\n");
  }
  TextTable differing{.heading = {"key", "value", "default", "unit"}, .rows = {}, .cells = Cells::kWords};
  TextTable usual{.heading = {"key", "value", "unit"}, .rows = {}, .cells = Cells::kWords};
  for (const RunFolder::Setting& setting : run.settings) {
    if (setting.differs()) {
      differing.rows.push_back({setting.name, setting.value, setting.usual, setting.unit});
    } else {
      usual.rows.push_back({setting.name, setting.value, setting.unit});
    }
  }
  return details(fmt::format("{} keys that differ from their defaults", differing.rows.size()), table_html(differing)) +
         details(fmt::format("{} keys at their defaults", usual.rows.size()), table_html(usual));
}

std::string reasons_table(const std::vector<NamedRun>& runs) {
  constexpr std::size_t kMostColumns = 4;  // of more runs it is told in words how often each had a reason
  const bool in_words = runs.size() > kMostColumns;
  TextTable table{.heading = {"frames without an accepted measurement"}, .rows = {}};
  if (in_words) {
    table.cells = Cells::kFigures;
    table.heading.insert(table.heading.end(), {"in all", "of them by"});
  }
  std::vector<std::string> kinds;
  std::vector<std::vector<ReasonCount>> reasons;
  for (const NamedRun& named : runs) {
    if (!in_words) table.heading.push_back(named.name);
    reasons.push_back(reasons_of(*named.run));
    for (const ReasonCount& reason : reasons.back()) {
      if (std::find(kinds.begin(), kinds.end(), reason.kind) == kinds.end()) kinds.push_back(reason.kind);
    }
  }
  for (const std::string& kind : kinds) {
    std::vector<std::pair<int, std::string>> counts;
    for (std::size_t k = 0; k < runs.size(); ++k) {
      const auto found = std::find_if(reasons[k].begin(), reasons[k].end(),
                                      [&](const ReasonCount& reason) { return reason.kind == kind; });
      counts.emplace_back(found == reasons[k].end() ? 0 : found->count, runs[k].name);
    }
    std::vector<std::string> cells = in_words ? counts_in_words(std::move(counts)) : counts_alone(counts);
    cells.insert(cells.begin(), kind);
    table.rows.push_back(std::move(cells));
  }
  return table_html(table);
}

std::string styles_note(std::size_t runs) {
  if (runs <= static_cast<std::size_t>(kCurveStyles)) return "";
  return paragraph(fmt::format("There are more curves than kinds of them: every {}th looks alike.", kCurveStyles));
}

std::vector<std::string> short_names(const std::vector<RunFolder>& runs) {
  std::vector<std::vector<std::string>> parts;
  std::size_t longest = 1;
  for (const RunFolder& run : runs) {
    parts.push_back(parts_of(run.folder));
    longest = std::max(longest, parts.back().size());
  }
  std::vector<std::string> names;
  for (std::size_t count = 1; count <= longest; ++count) {
    names.clear();
    for (const auto& own : parts) names.push_back(last_parts(own, count));
    std::vector<std::string> sorted = names;
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end()) break;
  }
  return names;
}

std::string samples_html(const RunFolder& run) {
  std::string figures;
  for (const SampleFrame& sample : run.samples) {
    if (sample.picture.empty()) continue;
    figures +=
        fmt::format("<figure>\n<img alt=\"Frame {}\" src=\"{}\"/>\n<figcaption>{}</figcaption>\n</figure>\n",
                    sample.frame, data_address("image/jpeg", sample.picture), escape_html(sample_caption(sample, run)));
  }
  if (figures.empty()) return "";
  return "<p>Lines go from where a point was to where it went. Circles fit, crosses don't. Points of the whole image "
         "are "
         "green (red where they don't fit the motion), those of the road yellow (magenta where they don't fit the "
         "plane). The region of the road is tinted; the grid is the plane, lines 2 m apart across and 5 m along. "
         "Each picture is the pair's earlier view.</p>\n"
         "<div class=\"samples\">\n" +
         figures + "</div>\n";
}

}  // namespace groundscale::internal
