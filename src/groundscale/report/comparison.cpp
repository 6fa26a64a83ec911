#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "groundscale/core/check.hpp"
#include "groundscale/evaluation/figures.hpp"
#include "groundscale/report/markup_internal.hpp"
#include "groundscale/report/page_internal.hpp"
#include "groundscale/report/run_charts_internal.hpp"
#include "groundscale/report/run_parts_internal.hpp"
#include "groundscale/report/run_report.hpp"

namespace groundscale {
namespace {

using internal::escape_html;
using internal::NamedRun;
using internal::section;
using internal::table_html;
using internal::TextTable;

using Row = std::vector<std::string>;
const std::string kNothing = "\u2013";

std::string number(std::optional<double> value, int decimals, bool sign = false) {
  if (!value || !std::isfinite(*value)) return kNothing;
  return sign ? fmt::format("{:+.{}f}", *value, decimals) : fmt::format("{:.{}f}", *value, decimals);
}

std::string setting(const RunFolder& run, const std::string& name) {
  for (const RunFolder::Setting& s : run.settings) {
    if (s.name == name) return s.value;
  }
  return kNothing;
}

/// The same without the quotes of text.
std::string word(const RunFolder& run, const std::string& name) {
  std::string value = setting(run, name);
  if (value.size() >= 2 && value.starts_with('"') && value.ends_with('"')) value = value.substr(1, value.size() - 2);
  return value;
}

std::string grade_in_words(const RunFolder& run) {
  const RunVerdict verdict = verdict_of(run);
  if (verdict.grade == Grade::kBad) return "bad";
  const auto count = std::count_if(verdict.findings.begin(), verdict.findings.end(),
                                   [](const Finding& finding) { return finding.grade == Grade::kReservation; });
  return count == 0 ? "good" : fmt::format("{} reservation{}", count, count == 1 ? "" : "s");
}

/// A row a figure of the run itself.
struct RunFigure {
  const char* name;
  std::string (*of)(const RunFolder&);
};

constexpr RunFigure kRunFigures[] = {
    {"verdict", grade_in_words},
    {"mode", [](const RunFolder& r) { return word(r, "odometry.mode"); }},
    {"scale correction", [](const RunFolder& r) { return word(r, "odometry.scale_correction"); }},
    {"method", [](const RunFolder& r) { return word(r, "ground.method"); }},
    {"frames", [](const RunFolder& r) { return fmt::to_string(r.summary.frames); }},
    {"first frame", [](const RunFolder& r) { return fmt::to_string(r.summary.first_frame); }},
    {"length, m", [](const RunFolder& r) { return number(r.summary.length_m, 2); }},
    {"camera height, m", [](const RunFolder& r) { return number(r.summary.camera_height_m, 3); }},
    {"moving frames", [](const RunFolder& r) { return fmt::to_string(r.summary.moving); }},
    {"with an accepted measurement, %",
     [](const RunFolder& r) {
       return r.summary.moving > 0 ? number(100.0 * r.summary.accepted / r.summary.moving, 1) : kNothing;
     }},
    {"longest way without, m", [](const RunFolder& r) { return number(longest_gap_m(r), 0); }},
    {"sd of the online step, median %",
     [](const RunFolder& r) {
       const auto sd = median_relative_sd(r);
       return sd ? number(100.0 * *sd, 2) : kNothing;
     }},
    {"frames lost", [](const RunFolder& r) { return fmt::to_string(r.summary.lost); }},
    {"frames bridged", [](const RunFolder& r) { return fmt::to_string(r.summary.bridged); }},
    {"corrections of the scale", [](const RunFolder& r) { return fmt::to_string(r.summary.corrections.size()); }},
    {"drift against the road, % per 100 m",
     [](const RunFolder& r) {
       return r.summary.slope ? number(100.0 * r.summary.slope->per_100m, 1, true) + " \u00b1 " +
                                    number(100.0 * r.summary.slope->sd_per_100m, 1)
                              : kNothing;
     }},
    {"pitch of the road, sd in degrees", [](const RunFolder& r) { return number(r.summary.matching.pitch_sd_deg, 2); }},
    {"ms a frame, median", [](const RunFolder& r) { return number(r.summary.median_ms, 1); }},
    {"ms a frame, 95 % below", [](const RunFolder& r) { return number(r.summary.p95_ms, 1); }},
    {"warnings", [](const RunFolder& r) { return fmt::to_string(r.summary.warnings.size()); }}};

Row heading(const std::vector<std::string>& names) {
  Row cells = {"figure"};
  cells.insert(cells.end(), names.begin(), names.end());
  return cells;
}

std::string figures_table(const std::vector<RunFolder>& runs, const std::vector<std::string>& names) {
  TextTable table{.heading = heading(names), .rows = {}};
  for (const RunFigure& figure : kRunFigures) {
    Row cells = {figure.name};
    for (const RunFolder& run : runs) cells.push_back(figure.of(run));
    table.rows.push_back(std::move(cells));
  }
  return table_html(table);
}

/// Those that are seen at once; the others are a click away.
constexpr std::string_view kMainFigures[] = {"scale_bias",
                                             "scale_spread",
                                             "scale_error_p95",
                                             "scale_drift",
                                             "t_rel",
                                             "r_rel",
                                             "ate_se3",
                                             "sim3_scale",
                                             "online_t_rel",
                                             "raw_scale_bias",
                                             "raw_scale_spread",
                                             "coverage",
                                             "online_within_2_sd"};

/// Rows in the order of the run that has most of them.
std::string truth_table(const std::vector<RunFolder>& runs, const std::vector<std::string>& names) {
  std::vector<std::vector<Figure>> figures;
  const std::vector<Figure>* longest = nullptr;
  figures.reserve(runs.size());
  for (const RunFolder& run : runs) {
    figures.emplace_back();
    if (!run.compared) continue;
    for (const FigureGroup& group : figures_of(run.compared->evaluation)) {
      figures.back().insert(figures.back().end(), group.figures.begin(), group.figures.end());
    }
    if (longest == nullptr || figures.back().size() > longest->size()) longest = &figures.back();
  }
  if (longest == nullptr) return "";
  TextTable main{.heading = heading(names), .rows = {}};
  TextTable others = main;
  for (const Figure& figure : *longest) {
    Row cells = {figure.unit.empty() ? figure.name : fmt::format("{}, {}", figure.name, figure.unit)};
    for (const std::vector<Figure>& own : figures) {
      const auto found = std::find_if(own.begin(), own.end(), [&](const Figure& f) { return f.name == figure.name; });
      cells.push_back(found == own.end() ? kNothing : number(found->value, found->decimals, found->sign));
    }
    const bool is_main =
        std::find(std::begin(kMainFigures), std::end(kMainFigures), figure.name) != std::end(kMainFigures);
    (is_main ? main : others).rows.push_back(std::move(cells));
  }
  return table_html(main) +
         fmt::format("<details>\n<summary>{} more figures</summary>\n{}</details>\n", others.rows.size(),
                     table_html(others)) +
         "<p>Defined in docs/evaluation.md of groundscale; scale is never aligned unless a figure's name says "
         "so.</p>\n";
}

std::string settings_table(const std::vector<RunFolder>& runs, const std::vector<std::string>& names) {
  TextTable table{.heading = heading(names), .rows = {}, .cells = internal::Cells::kWords};
  table.heading.front() = "key";
  for (const RunFolder::Setting& first : runs.front().settings) {
    Row cells = {first.name};
    for (const RunFolder& run : runs) cells.push_back(setting(run, first.name));
    const bool alike = std::all_of(cells.begin() + 1, cells.end(), [&](const std::string& c) { return c == cells[1]; });
    if (!alike) table.rows.push_back(std::move(cells));
  }
  return table_html(table);
}

/// Runs of one drive.
struct Group {
  std::string drive;
  std::vector<NamedRun> runs;
};

std::vector<Group> groups_of(const std::vector<RunFolder>& runs, const std::vector<std::string>& names) {
  std::vector<Group> groups;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.drive == runs[k].drive; });
    if (group == groups.end()) group = groups.insert(groups.end(), {runs[k].drive, {}});
    group->runs.push_back({names[k], &runs[k]});
  }
  return groups;
}

std::string names_of_runs(const Group& group) {
  std::string names;
  for (const NamedRun& named : group.runs) names += (names.empty() ? "" : ", ") + named.name;
  return names;
}

/// What must be known before runs are compared.
std::string notes(const std::vector<Group>& groups) {
  std::string html;
  if (groups.size() > 1) {
    html = fmt::format(
        "<p class=\"note\"><b>These runs are of {} different drives:</b> their figures say nothing of "
        "which run is better, and only curves of the same drive lie over each other.</p>\n<ul>\n",
        groups.size());
    for (const Group& group : groups) {
      html += fmt::format("<li>{}: {}</li>\n", escape_html(group.drive), escape_html(names_of_runs(group)));
    }
    html += "</ul>\n";
  }
  for (const Group& group : groups) {
    const int frames = group.runs.front().run->summary.frames;
    const bool alike = std::all_of(group.runs.begin(), group.runs.end(),
                                   [frames](const NamedRun& r) { return r.run->summary.frames == frames; });
    if (alike) continue;
    html += fmt::format(
        "<p class=\"note\"><b>The runs of {} have different numbers of frames:</b> their figures are over "
        "different ways.</p>\n",
        escape_html(group.drive));
  }
  return html;
}

std::string curves(const Group& group) {
  const std::string html = fmt::format("<p>Drive: {}</p>\n", escape_html(group.drive));
  return html + internal::styles_note(group.runs.size()) + internal::trajectory_figure(group.runs) +
         internal::pieces_figure(group.runs) + internal::sd_figure(group.runs) + internal::pitch_figure(group.runs) +
         internal::roll_figure(group.runs);
}

}  // namespace

std::string comparison_html(const std::vector<RunFolder>& runs) {
  GS_CHECK(runs.size() >= 2, "there are several runs to compare");
  const std::vector<std::string> names = internal::short_names(runs);
  const std::vector<Group> groups = groups_of(runs, names);
  std::vector<NamedRun> all;
  std::string verdicts;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    all.push_back({names[k], &runs[k]});
    verdicts += fmt::format("<h3>{}</h3>\n{}", escape_html(names[k]), internal::verdict_html(verdict_of(runs[k])));
  }
  std::string drives;
  for (const Group& group : groups) {
    drives += section(groups.size() > 1 ? "Curves: " + escape_html(names_of_runs(group)) : "Curves", curves(group));
  }
  std::vector<std::pair<std::string, std::string>> folders;
  for (std::size_t k = 0; k < runs.size(); ++k) folders.emplace_back(names[k], runs[k].folder);
  return internal::page(fmt::format("{} runs beside each other", runs.size()),
                        notes(groups) + section("Figures", figures_table(runs, names)) +
                            section("Against the truth", truth_table(runs, names)) +
                            section("Configuration that differs", settings_table(runs, names)) +
                            section("Coverage", internal::reasons_table(all)) + drives + section("Verdicts", verdicts) +
                            section("Folders", internal::definitions(folders)));
}

}  // namespace groundscale
