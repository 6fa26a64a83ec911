#include "groundscale/report/calibration_report.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "groundscale/io/files.hpp"
#include "groundscale/report/calibration_figures_internal.hpp"
#include "groundscale/report/markup_internal.hpp"
#include "groundscale/report/page_internal.hpp"

namespace groundscale {
namespace {

using internal::escape_html;
using internal::page;
using internal::section;

/// A value as exact as its error is known: the sd with two digits.
std::string number(double value, double sd) {
  if (!(sd > 0.0) || !std::isfinite(sd)) return fmt::format("{:.6g}", value);
  constexpr int kMostDecimals = 12;
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(sd))), 0, kMostDecimals);
  return fmt::format("{:.{}f}", value, decimals);
}

std::string parameter_table(const std::vector<CalibrationReport::Parameter>& parameters) {
  if (parameters.empty()) return "";
  std::string html =
      "<table>\n<thead><tr><th>parameter</th><th>before</th><th>after</th><th>sd</th></tr></thead>\n<tbody>\n";
  for (const CalibrationReport::Parameter& parameter : parameters) {
    const double sd = parameter.sd;
    const std::string unit =
        parameter.unit.empty() ? "" : fmt::format(" <span class=\"unit\">{}</span>", escape_html(parameter.unit));
    html +=
        fmt::format("<tr><th>{}{}</th><td>{}</td><td>{}</td><td>{}</td></tr>\n", escape_html(parameter.name), unit,
                    number(parameter.before, sd), number(parameter.after, sd), sd > 0.0 ? number(sd, sd) : "\u2013");
    if (!parameter.reason.empty()) {
      html += fmt::format("<tr><td class=\"reason\" colspan=\"4\">stays as it was: {}</td></tr>\n",
                          escape_html(parameter.reason));
    }
  }
  return html + "</tbody>\n</table>\n";
}

std::string fact_list(const std::vector<CalibrationReport::Fact>& facts) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const CalibrationReport::Fact& fact : facts) pairs.emplace_back(fact.label, fact.value);
  return internal::definitions(pairs);
}

std::string map_keys(const internal::MapScale& scale) {
  std::string html = "<ul class=\"keys\">\n";
  for (std::size_t k = 0; k < internal::kResidualColours.size(); ++k) {
    const double step = scale.colour_step_px;
    const auto below = static_cast<double>(k);
    html += fmt::format("<li>{}{} to {} px</li>\n", internal::colour_key(internal::kResidualColours[k]),
                        internal::step_label(below * step, step), internal::step_label((below + 1.0) * step, step));
  }
  return html + fmt::format("<li>{}fewer than {} residuals</li>\n</ul>\n",
                            internal::colour_key(internal::kLeftOutColour), internal::kLeastResiduals);
}

std::string map_figure(const ResidualMap& map, const internal::MapScale& scale, std::string_view name) {
  const double pattern_px = map.pattern_px(internal::kLeastResiduals);
  const std::string size =
      std::isnan(pattern_px) ? "too few for a map" : fmt::format("rms of their means {:.3f} px", pattern_px);
  return fmt::format("<figure>\n<figcaption>{}: {} residuals, {}</figcaption>\n{}</figure>\n", name, map.count(), size,
                     residual_map_svg(map, scale, fmt::format("Mean residuals over the image, {}", name)));
}

std::string residual_maps(const CalibrationReport& report) {
  std::vector<const ResidualMap*> maps;
  for (const auto* map : {&report.residuals_before, &report.residuals_after}) {
    if (*map) maps.push_back(&**map);
  }
  if (maps.empty()) return "";
  const internal::MapScale scale = internal::common_scale(maps);
  std::string html = fmt::format(
      "<p>Where points are projected, less where they were seen: the mean in each cell of the image. The arrows are "
      "{:.6g} times as long as the residuals, in all maps. With the right camera they are short and point anywhere; a "
      "wrong one leaves a pattern.</p>\n",
      scale.magnification);
  // Wide images one above the other: half as wide they would be strips.
  const bool wide = maps.front()->width > 2 * maps.front()->height;
  html += wide ? "<div>\n" : "<div class=\"pair\">\n";
  if (report.residuals_before) html += map_figure(*report.residuals_before, scale, "before");
  if (report.residuals_after) html += map_figure(*report.residuals_after, scale, "after");
  return html + "</div>\n" + map_keys(scale);
}

std::string slope_line(const ScaleSlope& slope, internal::SlopeSeries series) {
  return fmt::format("<li>{}{}: {:+.2f} \u00b1 {:.2f} % per 100 m, {} measurements over {:.0f} m</li>\n",
                     slope_key(series), series == internal::SlopeSeries::kBefore ? "before" : "after",
                     100.0 * slope.per_100m, 100.0 * slope.sd_per_100m, slope.measurements, slope.length_m);
}

std::string drift_figure(const CalibrationReport::Drift& drift) {
  if (!drift.before && !drift.after) return "";
  const internal::SlopeFigure figure =
      internal::slope_figure(drift.before ? &*drift.before : nullptr, drift.after ? &*drift.after : nullptr,
                             "Scale of the odometry over the ground's by distance, " + drift.drive);
  std::string html = "<figure>\n";
  if (!drift.drive.empty()) html += fmt::format("<figcaption>{}</figcaption>\n", escape_html(drift.drive));
  html += figure.svg + "<ul class=\"keys\">\n";
  if (drift.before) html += slope_line(*drift.before, internal::SlopeSeries::kBefore);
  if (drift.after) html += slope_line(*drift.after, internal::SlopeSeries::kAfter);
  html += "</ul>\n";
  std::string left_out;
  if (figure.drawn < figure.within) left_out += fmt::format("{} of {} are drawn. ", figure.drawn, figure.within);
  if (figure.outside > 0) left_out += fmt::format("{} measurements lie outside.", figure.outside);
  if (!left_out.empty()) html += "<p>" + left_out + "</p>\n";
  return html + "</figure>\n";
}

std::string drift_figures(const std::vector<CalibrationReport::Drift>& drifts) {
  std::string html;
  for (const CalibrationReport::Drift& drift : drifts) html += drift_figure(drift);
  if (html.empty()) return "";
  return "<p>How far the odometry's scale, left to itself, is from what the ground says, and straight lines through "
         "it. With the right camera the line is level.</p>\n" +
         html;
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
    lines.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return lines;
}

/// With the lines marked that the other text hasn't.
std::string camera_text(std::string_view name, const std::string& text, const std::string& other) {
  if (text.empty()) return "";
  const auto other_lines = lines_of(other);
  const std::set<std::string_view> known(other_lines.begin(), other_lines.end());
  std::string html = fmt::format("<div>\n<h3>{}</h3>\n<pre>", name);
  for (const std::string_view line : lines_of(text)) {
    const bool differs = !other.empty() && !known.contains(line);
    html += differs ? fmt::format("<mark>{}</mark>", escape_html(line)) : escape_html(line);
  }
  return html + "</pre>\n</div>\n";
}

std::string camera_files(const CalibrationReport& report) {
  const std::string html = camera_text("before", report.camera_before, report.camera_after) +
                           camera_text("after", report.camera_after, report.camera_before);
  return html.empty() ? "" : "<div class=\"pair\">\n" + html + "</div>\n";
}

}  // namespace

std::string calibration_report_html(const CalibrationReport& report) {
  const std::string verdict =
      fmt::format("<p class=\"verdict{}\">{}</p>\n", report.adopted ? " adopted" : "", escape_html(report.verdict));
  return page(report.title, verdict + section("Parameters", parameter_table(report.parameters)) +
                                section("Facts", fact_list(report.facts)) +
                                section("Residuals over the image", residual_maps(report)) +
                                section("Drift of the scale", drift_figures(report.drifts)) +
                                section("Camera file", camera_files(report)));
}

Result<void> write_calibration_report(const std::string& path, const CalibrationReport& report) {
  return write_text(path, calibration_report_html(report));
}

}  // namespace groundscale
