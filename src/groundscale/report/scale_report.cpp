#include "groundscale/report/scale_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/report/chart_internal.hpp"
#include "groundscale/report/markup_internal.hpp"
#include "groundscale/report/page_internal.hpp"
#include "groundscale/report/run_charts_internal.hpp"
#include "groundscale/report/run_parts_internal.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::bad_input;
using internal::escape_html;
using internal::NamedRun;
using internal::paragraph;
using internal::section;
using internal::TextTable;

const std::string kNothing = "\u2013";

enum Column { kMethod, kTime, kColumns };
constexpr std::array<std::string_view, kColumns> kNames{"method", "time_ms"};

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

std::string first_of(const MethodsReport& report) {
  return report.methods.empty() ? "" : report.methods.front().name();
}

/// What steps are compared with, in words.
std::string reference_of(const MethodsReport& report) {
  return report.by_truth() ? "the truth" : "the filtered steps of " + first_of(report);
}

std::string address_of(const MethodRun& method) { return method.name() + "/report.html"; }

std::string number(double value, int decimals) { return fmt::format("{:.{}f}", value, decimals); }

std::string methods_table(const MethodsReport& report) {
  TextTable table{.heading = {"method", "moving frames", "of them measured, %", "longest way without, m",
                              "sd of the filtered step, median %", "ms a frame, median", "95 % below"},
                  .rows = {}};
  if (report.by_truth()) table.heading.emplace_back("coverage by the truth, %");
  for (const MethodRun& method : report.methods) {
    const RunSummary& s = method.run.summary;
    const std::optional<double> sd = median_relative_sd(method.run);
    const std::vector<double>& times = method.times.time_ms;
    table.rows.push_back({method.name(), fmt::to_string(s.moving),
                          s.moving > 0 ? number(100.0 * s.accepted / s.moving, 1) : kNothing,
                          number(longest_gap_m(method.run), 0), sd ? number(100.0 * *sd, 2) : kNothing,
                          times.empty() ? kNothing : number(median(times), 2),
                          times.empty() ? kNothing : number(quantile(times, 0.95), 2)});
    if (report.by_truth()) {
      const auto& coverage = method.run.compared->evaluation.coverage;
      const bool known = coverage && coverage->accepted.of > 0;
      table.rows.back().push_back(known ? number(100.0 * coverage->accepted.value(), 1) : kNothing);
    }
    table.addresses.push_back(address_of(method));
  }
  std::string note =
      "A method's name leads to the page of its own run. Its time is that of the method alone, without matching and "
      "motion. Frames move where the odometry says so";
  note += report.by_truth() ? "; coverage is the share of steps measured among those that move by the truth." : ".";
  return internal::table_html(table) + paragraph(note);
}

void add_errors(const std::optional<ScaleErrors>& errors, std::vector<std::string>& cells) {
  cells.push_back(errors ? fmt::to_string(errors->steps) : "0");
  cells.push_back(errors ? fmt::format("{:+.2f}", 100.0 * errors->bias) : kNothing);
  for (const auto member : {&ScaleErrors::spread, &ScaleErrors::p95}) {
    cells.push_back(errors ? number(100.0 * (*errors).*member, 2) : kNothing);
  }
}

/// Errors of all methods, straights and turns apart. @param of  Of single measurements, or of the filtered steps.
std::string errors_table(const MethodsReport& report, const std::string& what,
                         std::optional<ScaleFigures> Evaluation::*of) {
  TextTable table{.heading = {what}, .rows = {}, .groups = {{"", 1}}};
  for (const char* part : {"all", "straights", "turns"}) {
    table.groups.emplace_back(part, 4);
    for (const char* figure : {"steps", "bias %", "spread %", "95 % within %"}) table.heading.emplace_back(figure);
  }
  for (const MethodRun& method : report.methods) {
    const ComparedRun* compared = method.compared();
    if (compared == nullptr) continue;
    const ScaleFigures figures = (compared->evaluation.*of).value_or(ScaleFigures{});
    std::vector<std::string> cells = {method.name()};
    for (const auto& part : {figures.all, figures.straight, figures.turn}) add_errors(part, cells);
    table.rows.push_back(std::move(cells));
  }
  return internal::table_html(table);
}

std::string errors_section(const MethodsReport& report) {
  const std::string tables = errors_table(report, "raw", &Evaluation::raw_scale) +
                             errors_table(report, "filtered online", &Evaluation::online_scale);
  if (tables.empty()) return "";
  return paragraph(fmt::format(
             "Moving steps over {}, less 1: bias is the median, spread the median of |ratio / median - 1|, 95 % of "
             "|ratio - 1| lie within the last. As docs/evaluation.md of groundscale defines them; nothing is aligned. "
             "Raw: accepted measurements of single frames.",
             report.by_truth() ? "true ones" : "the filtered ones of " + first_of(report))) +
         tables;
}

std::string charts(const MethodsReport& report) {
  std::string html;
  for (const MethodRun& method : report.methods) {
    const ComparedRun* compared = method.compared();
    html += fmt::format("<h3><a href=\"{}\">{}</a></h3>\n<div class=\"pair\">\n", escape_html(address_of(method)),
                        escape_html(method.name()));
    if (compared != nullptr) {
      html += internal::ratio_figure(method.run, *compared, "Steps over " + reference_of(report) + ", less 1");
    }
    const std::string angles = internal::angle_figure(method.run, "Pitch and roll of the road");
    html += (angles.empty() ? paragraph("No accepted measurement.") : angles) + "</div>\n";
  }
  return html;
}

std::string coverage_section(const MethodsReport& report, const std::vector<NamedRun>& runs) {
  std::vector<internal::Bar> bars;
  for (const MethodRun& method : report.methods) {
    const RunSummary& s = method.run.summary;
    const double share = 100.0 * s.accepted / std::max(1, s.moving);
    bars.push_back({method.name(), share, fmt::format("{:.1f} %", share)});
  }
  return paragraph("Moving frames with an accepted measurement:") +
         internal::bars_html(bars, "Share of moving frames with an accepted measurement") +
         internal::reasons_table(runs);
}

std::string times_section(const MethodsReport& report) {
  std::vector<internal::Bar> stages;
  for (const auto& [stage, ms] : report.matcher.summary.stage_ms) {
    stages.push_back({stage, ms, fmt::format("{:.2f} ms", ms)});
  }
  std::vector<internal::Bar> methods;
  for (const MethodRun& method : report.methods) {
    if (method.times.time_ms.empty()) continue;
    const double ms = median(method.times.time_ms);
    methods.push_back({method.name(), ms, fmt::format("{:.2f} ms", ms)});
  }
  std::string html;
  if (!stages.empty()) {
    html = paragraph("Mean time a frame of each stage that all methods have in common:") +
           internal::bars_html(stages, "Mean time a frame of each common stage");
  }
  return html + paragraph("Median time a frame of each method alone:") +
         internal::bars_html(methods, "Median time a frame of each method");
}

/// Those of the runs too, each once: that a truth can't be read, say.
std::vector<std::string> warnings_of(const MethodsReport& report) {
  std::vector<std::string> warnings = report.matcher.summary.warnings;
  if (!report.matcher.truth_problem.empty()) {
    warnings.push_back("nothing can be compared with the truth: " + report.matcher.truth_problem);
  }
  return warnings;
}

}  // namespace

const ComparedRun* MethodRun::compared() const {
  if (run.compared) return &*run.compared;
  return beside_first ? &*beside_first : nullptr;
}

Result<std::vector<MethodTimes>> read_method_times(const std::string& path) {
  const auto text = read_text(path);
  if (!text) return text.error();
  const std::vector<internal::Line> lines = internal::split_lines(*text);
  if (lines.empty()) return bad_input(path + ": empty, a header and a row a frame and method are expected");
  const auto header = parse_header(lines.front().text, path);
  if (!header) return header.error();
  std::vector<MethodTimes> methods;
  for (std::size_t k = 1; k < lines.size(); ++k) {
    if (internal::trimmed(lines[k].text).empty()) continue;
    const std::vector<std::string> fields = internal::csv_fields(lines[k].text);
    const std::string place = fmt::format("{}:{}", path, lines[k].number);
    if (fields.size() != header->width) {
      return bad_input(fmt::format("{}: {} fields, the header has {}", place, fields.size(), header->width));
    }
    const std::string& name = fields[header->index[kMethod]];
    auto method = std::find_if(methods.begin(), methods.end(), [&](const auto& m) { return m.method == name; });
    if (method == methods.end()) method = methods.insert(methods.end(), {name, {}});
    const std::string& time = fields[header->index[kTime]];
    if (time.empty()) continue;
    const std::optional<double> time_ms = internal::parse_number(time);
    if (!time_ms || !std::isfinite(*time_ms)) {
      return bad_input(
          fmt::format("{}: time_ms is {}, it must be a finite number, or empty", place, internal::quoted(time)));
    }
    method->time_ms.push_back(*time_ms);
  }
  if (methods.empty()) return bad_input(path + ": has no row");
  return methods;
}

Result<MethodsReport> read_methods_report(const std::string& folder) {
  const fs::path path = folder;
  auto times = read_method_times((path / "methods.csv").string());
  if (!times) return times.error();
  auto matcher = read_run_folder(folder);
  if (!matcher) return matcher.error();
  MethodsReport report{std::move(*matcher), {}};
  for (MethodTimes& own : *times) {
    auto run = read_run_folder((path / own.method).string());
    if (!run) return run.error();
    report.methods.push_back({std::move(own), std::move(*run), std::nullopt});
  }
  if (report.by_truth()) return report;
  const std::string first = (path / report.methods.front().name() / "online.tum").string();
  for (MethodRun& method : report.methods) {
    auto compared =
        compare_run({.estimate = method.run.folder, .truth = first, .truth_offset = -method.run.summary.first_frame});
    if (compared) method.beside_first = std::move(*compared);
  }
  return report;
}

std::string methods_page_html(const MethodsReport& report) {
  std::vector<NamedRun> runs;
  for (const MethodRun& method : report.methods) runs.push_back({method.name(), &method.run});
  const std::string settings = internal::settings_html(report.matcher);
  const std::string samples = internal::samples_html(report.matcher);
  return internal::page(
      fmt::format("Scale by {} method{}", runs.size(), runs.size() == 1 ? "" : "s"),
      internal::verdict_html(verdict_of(report)) + section("Drive", internal::facts_html(report.matcher)) +
          section("Methods", methods_table(report)) +
          section("Errors against " + escape_html(reference_of(report)), errors_section(report)) +
          section("Trajectory from above", internal::styles_note(runs.size()) + internal::trajectory_figure(runs)) +
          section("Steps, and pitch and roll of the road", charts(report)) +
          section("Uncertainty", internal::sd_figure(runs)) + section("Coverage", coverage_section(report, runs)) +
          section("Time", times_section(report)) +
          section("Sample frames",
                  samples.empty() ? "" : paragraph("Of the odometry that matched the images for all.") + samples) +
          section("Warnings", internal::list_html(warnings_of(report))) +
          section("Configuration", settings.empty() ? ""
                                                    : settings + paragraph("The methods differ in "
                                                                           "ground.method alone.")));
}

Result<void> write_scale_report(const std::string& folder) {
  const auto report = read_methods_report(folder);
  if (!report) return report.error();
  return write_text((fs::path(folder) / "report.html").string(), methods_page_html(*report));
}

}  // namespace groundscale
