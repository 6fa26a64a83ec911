#include "groundscale/report/scale_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "groundscale/report/chart_internal.hpp"
#include "groundscale/report/markup_internal.hpp"
#include "groundscale/report/page_internal.hpp"
#include "groundscale/report/run_charts_internal.hpp"
#include "groundscale/report/run_parts_internal.hpp"
#include "groundscale/report/sample_frames.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::bad_input;
using internal::Chart;
using internal::section;
using internal::TextTable;
using Json = nlohmann::ordered_json;

constexpr double kLeastStepM = 0.2;  // shorter reference steps say nothing of a ratio

enum Column { kFrame, kMethod, kRawStep, kRawStepSd, kOnlineStep, kPitch, kRoll, kInliers, kTime, kReason, kColumns };
constexpr std::array<std::string_view, kColumns> kNames{"frame",         "method",    "raw_step_m", "raw_step_sd_m",
                                                        "online_step_m", "pitch_deg", "roll_deg",   "inliers",
                                                        "time_ms",       "reason"};

struct Header {
  std::size_t width = 0;
  std::array<std::size_t, kColumns> index{};
};

Result<Header> parse_header(std::string_view line, const std::string& path) {
  const std::vector<std::string> names = internal::csv_fields(line);
  Header header;
  header.width = names.size();
  for (std::size_t column = 0; column < kColumns; ++column) {
    const auto found = std::find(names.begin(), names.end(), kNames[column]);
    if (found == names.end()) return bad_input(fmt::format("{}:1: no column '{}'", path, kNames[column]));
    header.index[column] = static_cast<std::size_t>(found - names.begin());
  }
  return header;
}

Result<std::pair<std::string, MethodRow>> parse_row(const internal::Line& line, const Header& header,
                                                    const std::string& path) {
  const std::vector<std::string> fields = internal::csv_fields(line.text);
  const std::string place = fmt::format("{}:{}", path, line.number);
  if (fields.size() != header.width) {
    return bad_input(fmt::format("{}: {} fields, the header has {}", place, fields.size(), header.width));
  }
  const auto field = [&](Column column) -> const std::string& { return fields[header.index[column]]; };
  MethodRow row;
  const auto frame = internal::parse_integer(field(kFrame));
  if (!frame || *frame < 0 || *frame > std::numeric_limits<int>::max()) {
    return bad_input(
        fmt::format("{}: frame is {}, it must be a frame number from 0 on", place, internal::quoted(field(kFrame))));
  }
  row.frame = static_cast<int>(*frame);
  row.reason = field(kReason);
  const std::pair<Column, std::optional<double>*> numbers[] = {
      {kRawStep, &row.raw_step_m}, {kRawStepSd, &row.raw_step_sd_m}, {kOnlineStep, &row.online_step_m},
      {kPitch, &row.pitch_deg},    {kRoll, &row.roll_deg},           {kInliers, &row.inliers},
      {kTime, &row.time_ms}};
  for (const auto& [column, value] : numbers) {
    if (field(column).empty()) continue;
    *value = internal::parse_number(field(column));
    if (*value && std::isfinite(**value)) continue;
    return bad_input(fmt::format("{}: {} is {}, it must be a finite number, or empty", place, kNames[column],
                                 internal::quoted(field(column))));
  }
  return std::pair(field(kMethod), std::move(row));
}

/// Reference steps by frame.
using Steps = std::map<int, double>;

Steps reference_of(const MethodsPage& report) {
  Steps steps;
  for (const auto& [frame, step_m] : report.true_steps_m) steps[frame] = step_m;
  if (!steps.empty() || report.methods.empty()) return steps;
  for (const MethodRow& row : report.methods.front().rows) {
    if (row.online_step_m) steps[row.frame] = *row.online_step_m;
  }
  return steps;
}

std::map<int, double> distances_of(const Steps& steps) {
  std::map<int, double> distances;
  double sum_m = 0.0;
  for (const auto& [frame, step_m] : steps) distances[frame] = (sum_m += step_m);
  return distances;
}

/// A step over the reference's; nothing where there is none worth dividing by.
std::optional<double> percent_off(const std::optional<double>& step_m, int frame, const Steps& reference) {
  const auto found = reference.find(frame);
  if (!step_m || found == reference.end() || found->second < kLeastStepM) return std::nullopt;
  return 100.0 * (*step_m / found->second - 1.0);
}

/// Median of absolute deviations from the median.
double spread_of(std::vector<double> values) {
  const double middle = median(values);
  for (double& value : values) value = std::abs(value - middle);
  return median(std::move(values));
}

std::string number(const std::vector<double>& values, int decimals, double (*of)(std::vector<double>)) {
  return values.empty() ? "\u2013" : fmt::format("{:.{}f}", of(values), decimals);
}

double middle_of(std::vector<double> values) { return median(std::move(values)); }
double high_of(std::vector<double> values) { return quantile(std::move(values), 0.95); }

std::vector<double> errors_of(const MethodRows& method, const Steps& reference, bool raw) {
  std::vector<double> errors;
  for (const MethodRow& row : method.rows) {
    if (raw && !row.accepted()) continue;
    if (const auto off = percent_off(raw ? row.raw_step_m : row.online_step_m, row.frame, reference)) {
      errors.push_back(*off);
    }
  }
  return errors;
}

std::string methods_table(const MethodsPage& report, const Steps& reference) {
  TextTable table{.heading = {"method", "frames", "measured", "raw bias %", "raw spread %", "raw 95 % within %",
                              "filtered bias %", "filtered spread %", "ms, median", "ms, 95 % below"},
                  .rows = {}};
  for (const MethodRows& method : report.methods) {
    std::vector<double> times;
    int accepted = 0;
    for (const MethodRow& row : method.rows) {
      accepted += row.accepted() ? 1 : 0;
      if (row.time_ms) times.push_back(*row.time_ms);
    }
    const std::vector<double> raw = errors_of(method, reference, true);
    const std::vector<double> filtered = errors_of(method, reference, false);
    std::vector<double> sizes = raw;
    for (double& size : sizes) size = std::abs(size);
    table.rows.push_back({method.method, fmt::to_string(method.rows.size()), fmt::to_string(accepted),
                          number(raw, 2, middle_of), number(raw, 2, spread_of), number(sizes, 2, high_of),
                          number(filtered, 2, middle_of), number(filtered, 2, spread_of), number(times, 2, middle_of),
                          number(times, 2, high_of)});
  }
  return internal::table_html(table);
}

std::string method_chart(const MethodRows& method, const Steps& reference, const std::string& against) {
  const std::map<int, double> distances = distances_of(reference);
  Chart chart{.name = "Steps by the method over " + against + " by distance",
              .x_name = "distance, m",
              .y_name = "over " + against + ", %",
              .height = 180.0,
              .bands = {},
              .curves = {{.name = "raw, refused", .drawn = internal::Drawn::kCrosses, .style = 4, .points = {}},
                         {.name = "raw", .drawn = internal::Drawn::kRings, .style = 1, .points = {}},
                         {.name = "filtered", .style = 0, .points = {}}},
              .events = {},
              .level = 0.0};
  for (const MethodRow& row : method.rows) {
    const auto at = distances.find(row.frame);
    if (at == distances.end()) continue;
    if (const auto raw = percent_off(row.raw_step_m, row.frame, reference)) {
      chart.curves[row.accepted() ? 1 : 0].points.push_back({at->second, *raw});
    }
    if (const auto filtered = percent_off(row.online_step_m, row.frame, reference)) {
      chart.curves[2].points.push_back({at->second, *filtered});
    }
  }
  return internal::chart_html(chart, method.method);
}

std::string reasons_table(const MethodsPage& report) {
  TextTable table{.heading = {"frames without an accepted measurement"}, .rows = {}};
  std::vector<std::string> kinds;
  std::vector<std::map<std::string, int>> counts;
  for (const MethodRows& method : report.methods) {
    table.heading.push_back(method.method);
    counts.emplace_back();
    for (const MethodRow& row : method.rows) {
      if (row.reason.empty()) continue;
      const std::string kind = kind_of_reason(row.reason);
      if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) kinds.push_back(kind);
      ++counts.back()[kind];
    }
  }
  for (const std::string& kind : kinds) {
    std::vector<std::string> cells = {kind};
    for (const auto& own : counts) {
      const auto found = own.find(kind);
      cells.push_back(fmt::to_string(found == own.end() ? 0 : found->second));
    }
    table.rows.push_back(std::move(cells));
  }
  return internal::table_html(table);
}

std::string times_figure(const MethodsPage& report) {
  std::vector<internal::Bar> bars;
  for (const MethodRows& method : report.methods) {
    std::vector<double> times;
    for (const MethodRow& row : method.rows) {
      if (row.time_ms) times.push_back(*row.time_ms);
    }
    if (times.empty()) continue;
    const double ms = median(std::move(times));
    bars.push_back({method.method, ms, fmt::format("{:.2f} ms", ms)});
  }
  return internal::bars_html(bars, "Median time a frame of each method");
}

/// What summary.json says at its top.
void take_summary(const Json& json, MethodsPage& report) {
  for (const auto& [key, value] : json.items()) {
    if (value.is_string()) report.facts.emplace_back(key, value.get<std::string>());
    if (value.is_number()) report.facts.emplace_back(key, fmt::format("{:.6g}", value.get<double>()));
    if (key != "warnings" || !value.is_array()) continue;
    for (const Json& warning : value) {
      if (warning.is_string()) report.warnings.push_back(warning.get<std::string>());
    }
  }
}

/// A truth that can't be read is a warning.
void take_truth(const Json& json, MethodsPage& report) {
  const auto named = json.find("truth");
  if (named == json.end() || !named->is_string() || named->get<std::string>().empty()) return;
  const auto truth = read_trajectory(named->get<std::string>());
  if (!truth) {
    report.warnings.push_back("the truth can't be read: " + truth.error().message);
    return;
  }
  const auto& poses = truth->world_from_cam;
  for (std::size_t k = 1; k < poses.size(); ++k) {
    report.true_steps_m.emplace_back(static_cast<int>(k), (poses[k].translation - poses[k - 1].translation).norm());
  }
}

}  // namespace

Result<std::vector<MethodRows>> read_methods_table(const std::string& path) {
  const auto text = read_text(path);
  if (!text) return text.error();
  const std::vector<internal::Line> lines = internal::split_lines(*text);
  if (lines.empty()) return bad_input(path + ": empty, a header and a row a frame and method are expected");
  const auto header = parse_header(lines.front().text, path);
  if (!header) return header.error();
  std::vector<MethodRows> methods;
  for (std::size_t k = 1; k < lines.size(); ++k) {
    if (internal::trimmed(lines[k].text).empty()) continue;
    auto row = parse_row(lines[k], *header, path);
    if (!row) return row.error();
    auto method = std::find_if(methods.begin(), methods.end(), [&](const auto& m) { return m.method == row->first; });
    if (method == methods.end()) method = methods.insert(methods.end(), {row->first, {}});
    method->rows.push_back(std::move(row->second));
  }
  if (methods.empty()) return bad_input(path + ": has no row");
  return methods;
}

std::string methods_page_html(const MethodsPage& report) {
  const Steps reference = reference_of(report);
  const std::string first = report.methods.empty() ? "" : report.methods.front().method;
  const std::string against = report.true_steps_m.empty() ? "the filtered step of " + first : "the truth";
  std::string charts;
  for (const MethodRows& method : report.methods) charts += method_chart(method, reference, against);
  const std::string note =
      internal::escape_html(fmt::format("Steps over {}; bias is the median, spread the median distance from it. Raw: "
                                        "accepted measurements of single frames.",
                                        against));
  std::vector<internal::NamedRun> runs;
  for (const RunFolder& run : report.runs) runs.push_back({fs::path(run.folder).filename().string(), &run});
  const std::string paths = runs.empty() ? "" : internal::trajectory_figure(runs);
  const std::string angles = runs.empty() ? "" : internal::pitch_figure(runs);
  const std::string sds = runs.empty() ? "" : internal::sd_figure(runs);
  const std::string samples = report.matcher ? internal::samples_html(*report.matcher) : "";
  return internal::page(
      report.title, section("Drive", internal::definitions(report.facts)) +
                        section("Methods", "<p>" + note + "</p>\n" + methods_table(report, reference)) +
                        section("Trajectory from above", paths) + section("Step ratios", charts) +
                        section("Uncertainty", sds) + section("Pitch of the road", angles) +
                        section("Refusals", reasons_table(report)) + section("Time", times_figure(report)) +
                        section("Sample frames", samples) + section("Warnings", internal::list_html(report.warnings)));
}

Result<void> write_scale_report(const std::string& folder) {
  const fs::path path = folder;
  MethodsPage report;
  auto methods = read_methods_table((path / "methods.csv").string());
  if (!methods) return methods.error();
  report.methods = std::move(*methods);
  report.title = fmt::format("Scale by {} methods", report.methods.size());
  const std::string summary = (path / "summary.json").string();
  std::error_code ignored;
  if (fs::exists(summary, ignored)) {
    const auto text = read_text(summary);
    if (!text) return text.error();
    const Json json = Json::parse(*text, nullptr, /*allow_exceptions=*/false);
    if (!json.is_object()) return bad_input(summary + ": isn't JSON");
    take_summary(json, report);
    take_truth(json, report);
  }
  if (auto matcher = read_run_folder(folder)) report.matcher = std::move(*matcher);
  for (const MethodRows& method : report.methods) {
    if (auto run = read_run_folder((path / method.method).string())) report.runs.push_back(std::move(*run));
  }
  return write_text((path / "report.html").string(), methods_page_html(report));
}

}  // namespace groundscale
