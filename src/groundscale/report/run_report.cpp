#include "groundscale/report/run_report.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "groundscale/evaluation/figures.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/report/markup_internal.hpp"
#include "groundscale/report/page_internal.hpp"
#include "groundscale/report/run_charts_internal.hpp"
#include "groundscale/report/run_parts_internal.hpp"

namespace groundscale {
namespace {

using internal::Cells;
using internal::details;
using internal::paragraph;
using internal::section;
using internal::table_html;
using internal::TextTable;

std::string figure_value(const Figure& figure) {
  if (!figure.value || !std::isfinite(*figure.value)) return "\u2013";
  return figure.sign ? fmt::format("{:+.{}f}", *figure.value, figure.decimals)
                     : fmt::format("{:.{}f}", *figure.value, figure.decimals);
}

std::string truth_section(const RunFolder& run) {
  if (!run.truth_problem.empty()) return paragraph("The run can't be compared with the truth: " + run.truth_problem);
  if (!run.compared) return "";
  std::string html = internal::truth_figure(run);
  for (const FigureGroup& group : figures_of(run.compared->evaluation)) {
    TextTable table{.heading = {"figure", "value", "unit", "of", "meaning"}, .rows = {}, .cells = Cells::kFigures};
    for (const Figure& figure : group.figures) {
      table.rows.push_back({figure.name, figure_value(figure), figure.unit,
                            fmt::format("{} {}", figure.count, figure.of), figure.meaning});
    }
    // What the final trajectory is worth is seen at once, and printed.
    html += details(group.title, table_html(table), group.title.starts_with("final"));
  }
  return html + paragraph("Scale is never aligned unless a figure's name says so.");
}

std::string coverage_section(const RunFolder& run) {
  std::string html = internal::coverage_figure(run);
  TextTable table{.heading = {"why there is no accepted measurement", "frames", "share", "first at frame"}, .rows = {}};
  for (const internal::ReasonCount& reason : internal::reasons_of(run)) {
    table.rows.push_back({reason.kind, fmt::to_string(reason.count),
                          fmt::format("{:.1f} %", 100.0 * reason.count / static_cast<double>(run.frames.size())),
                          fmt::to_string(reason.first_frame)});
  }
  const std::string share = fmt::format("{} of {} moving frames have an accepted measurement of the road.",
                                        run.summary.accepted, run.summary.moving);
  return paragraph(share) + html + table_html(table);
}

std::string corrections_table(const std::vector<ScaleEvent>& corrections) {
  constexpr std::size_t kMost = 20;
  std::vector<ScaleEvent> shown = corrections;
  std::string html;
  if (shown.size() > kMost) {
    html = paragraph(fmt::format("The {} largest of {} corrections:", kMost, shown.size()));
    std::stable_sort(shown.begin(), shown.end(), [](const ScaleEvent& a, const ScaleEvent& b) {
      return std::abs(std::log(a.lambda)) > std::abs(std::log(b.lambda));
    });
    shown.resize(kMost);
    std::sort(shown.begin(), shown.end(), [](const ScaleEvent& a, const ScaleEvent& b) { return a.frame < b.frame; });
  }
  TextTable table{.heading = {"frame", "map scaled by", "drift ratio before", "and after"}, .rows = {}};
  for (const ScaleEvent& event : shown) {
    table.rows.push_back({fmt::to_string(event.frame), fmt::format("{:.4f}", event.lambda),
                          fmt::format("{:.4f}", event.drift_before),
                          event.drift_after ? fmt::format("{:.4f}", *event.drift_after) : "\u2013"});
  }
  return html + table_html(table);
}

std::string corrections_section(const RunSummary& summary) {
  std::string html = corrections_table(summary.corrections);
  TextTable table{.heading = {"frame", "number of the camera", "value", "sd"}, .rows = {}};
  for (const CameraEvent& event : summary.camera_changes) {
    for (const auto& [name, value] : event.values) {
      table.rows.push_back(
          {fmt::to_string(event.frame), name, fmt::format("{:.6g}", value.value), fmt::format("{:.2g}", value.sd)});
    }
  }
  if (!table.rows.empty()) html += "<h3>Camera, found anew</h3>\n" + table_html(table);
  return html.empty() ? paragraph("None: neither the map's scale nor the camera was changed.") : html;
}

std::string time_section(const RunSummary& summary) {
  std::vector<internal::Bar> bars;
  for (const auto& [stage, ms] : summary.stage_ms) bars.push_back({stage, ms, fmt::format("{:.2f} ms", ms)});
  if (bars.empty()) return "";
  if (!(summary.median_ms > 0.0)) {  // one of several methods that had the rest in common
    return paragraph("Mean time a frame, without what several methods had in common:") +
           internal::bars_html(bars, "Mean time a frame of the method");
  }
  std::string words = fmt::format("A frame took {:.1f} ms (median; 95 % below {:.1f} ms), the drive {:.1f} s.",
                                  summary.median_ms, summary.p95_ms, summary.wall_s);
  if (summary.network_runs > 0) {
    words += fmt::format(" The road network ran {} times, {:.1f} ms each.", summary.network_runs, summary.network_ms);
  }
  return paragraph(words + " Mean time a frame of each stage:") +
         internal::bars_html(bars, "Mean time a frame of each stage");
}

std::string scale_section(const RunFolder& run) {
  const std::string html = internal::step_figure(run) + internal::deviation_figure(run);
  return html.empty() ? paragraph("No step has a scale.") : html;
}

}  // namespace

std::string run_report_html(const RunFolder& run) {
  const RunVerdict verdict = verdict_of(run);
  const std::string name = internal::short_names({run}).front();
  const std::vector<internal::NamedRun> self = {{"estimate, final", &run}};
  return internal::page(
      "Run: " + name,
      internal::verdict_html(verdict) + section("What was run", internal::facts_html(run)) +
          section("Trajectory from above", internal::trajectory_figure(self)) +
          section("Against the truth", truth_section(run)) + section("Scale", scale_section(run)) +
          section("Scale of the map", internal::map_figure(run)) +
          section("Pitch and roll of the road", internal::angle_figure(run)) +
          section("Coverage", coverage_section(run)) + section("Corrections", corrections_section(run.summary)) +
          section("Time", time_section(run.summary)) + section("Sample frames", internal::samples_html(run)) +
          section("Warnings", internal::list_html(run.summary.warnings)) +
          section("Configuration", internal::settings_html(run)));
}

Result<void> write_run_report(const std::string& folder) {
  const auto run = read_run_folder(folder);
  if (!run) return run.error();
  return write_text((std::filesystem::path(folder) / "report.html").string(), run_report_html(*run));
}

}  // namespace groundscale
