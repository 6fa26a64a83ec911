#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "groundscale/evaluation/kitti_errors.hpp"
#include "groundscale/evaluation/pairing.hpp"
#include "groundscale/evaluation/steps.hpp"
#include "groundscale/experiments/drives.hpp"
#include "groundscale/experiments/drives_report_internal.hpp"
#include "groundscale/experiments/path_plots.hpp"
#include "groundscale/experiments/report_parts.hpp"

namespace groundscale::internal {
namespace {

/// What a drive itself and the process say. The figures of the evaluation follow.
std::vector<Column> first_columns() {
  return {{.name = "drive", .title = "drive", .text = true},
          {.name = "frames", .title = "frames", .decimals = 0, .averaged = false},
          {.name = "length_m", .title = "length m", .decimals = 0, .averaged = false},
          {.name = "moving_steps", .title = "moving steps", .decimals = 0, .averaged = false},
          {.name = "turn_steps", .title = "in turns", .decimals = 0, .averaged = false},
          {.name = "median_ms", .title = "ms a frame", .decimals = 1},
          {.name = "p95_ms", .title = "95 % below ms", .decimals = 1},
          {.name = "peak_memory_mb", .title = "memory MB", .decimals = 0},
          {.name = "wall_s", .title = "run s", .decimals = 1, .averaged = false}};
}

std::vector<Cell> first_cells(const FinishedDrive& drive) {
  const MeasuredRun& run = drive.run;
  const auto number = [](double value) { return Cell(std::optional(value)); };
  return {Cell(drive.name),         number(run.frames),         number(run.length_m),
          number(run.moving_steps), number(run.turn_steps),     number(run.median_ms),
          number(run.p95_ms),       number(run.peak_memory_mb), number(run.wall_s)};
}

/// Errors of scale have the same form whatever they are of: "raw_", "online_", "" for final.
std::vector<Column> scale_columns(const std::string& prefix) {
  const std::string of = prefix == "raw_" ? "raw " : prefix == "online_" ? "online " : "final ";
  std::vector<Column> columns;
  const auto add = [&](const std::string& name, const std::string& title, bool sign) {
    columns.push_back({.name = prefix + name, .title = title, .decimals = 2, .sign = sign});
  };
  for (const auto& [suffix, where] :
       {std::pair("", ""), std::pair("_straight", ", straights"), std::pair("_turn", ", turns")}) {
    const std::string whose = *suffix == '\0' ? of : "";
    add(std::string("scale_bias") + suffix, whose + "bias %" + where, true);
    add(std::string("scale_spread") + suffix, whose + "spread %" + where, false);
    add((prefix == "raw_" ? "p95" : "scale_error_p95") + std::string(suffix), whose + "95th percentile %" + where,
        false);
  }
  add("scale_drift", of + "drift % per 100 m", true);
  return columns;
}

std::vector<Column> figure_columns() {
  std::vector<Column> columns = {{.name = "coverage", .title = "coverage %", .decimals = 1},
                                 {.name = "t_rel", .title = "t_rel %", .decimals = 3},
                                 {.name = "r_rel", .title = "r_rel deg/100 m", .decimals = 3},
                                 {.name = "online_t_rel", .title = "online t_rel %", .decimals = 3},
                                 {.name = "length_ratio", .title = "length ratio", .decimals = 4},
                                 {.name = "rotation_error", .title = "rotation deg a frame", .decimals = 4}};
  for (const char* prefix : {"raw_", "online_", ""}) {
    for (Column& column : scale_columns(prefix)) columns.push_back(std::move(column));
  }
  columns.push_back({.name = "raw_rms_turn", .title = "rms %, turns", .decimals = 2});
  columns.push_back({.name = "online_within_2_sd_straight", .title = "within 2 sd %, straights", .decimals = 1});
  columns.push_back({.name = "online_within_2_sd_turn", .title = "within 2 sd %, turns", .decimals = 1});
  return columns;
}

std::vector<std::string> scale_names(const std::string& prefix) {
  std::vector<std::string> names = {"drive"};
  for (const Column& column : scale_columns(prefix)) names.push_back(column.name);
  if (prefix == "raw_") names.emplace_back("raw_rms_turn");
  if (prefix == "online_") names.insert(names.end(), {"online_within_2_sd_straight", "online_within_2_sd_turn"});
  return names;
}

Plot path_plot(const FinishedDrive& drive, const PairedDrive& paired) {
  std::vector<PlottedPath> paths = {{{"truth", "truth"}, from_first_pose(paired.truth)},
                                    {{"final", "estimate, final"}, from_first_pose(paired.estimate)}};
  if (paired.online) paths.push_back({{"online", "estimate, online"}, from_first_pose(*paired.online)});
  return trajectory_plot(drive.name, paths);
}

Plot scale_plot(const FinishedDrive& drive, const PairedDrive& paired, const std::vector<Step>& steps) {
  Plot plot{.name = "scale-" + drive.name,
            .title = fmt::format(
                "Drive {}: length of each moving step over the true one (beyond 0.85 and 1.15 not shown)", drive.name),
            .x_label = "true distance (m)",
            .y_label = "estimated / true step",
            .columns = {"frame", "distance_m", "raw_straight", "raw_turn", "final"},
            .rows = {},
            .curves = {{.title = "raw, straights", .x = 1, .y = 2, .style = CurveStyle::kPoints},
                       {.title = "raw, turns", .x = 1, .y = 3, .style = CurveStyle::kPoints},
                       {.title = "final", .x = 1, .y = 4}},
            .settings = {"set yrange [0.85:1.15]"}};
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const Step& step = steps[k];
    if (!step.moving) continue;
    const FrameRow& frame = paired.frames[k + 1];
    const std::optional<double> raw = frame.accepted() ? std::optional(*frame.raw_step_m / step.true_m) : std::nullopt;
    plot.rows.push_back({static_cast<double>(frame.frame), step.true_distance_m, step.turn ? std::nullopt : raw,
                         step.turn ? raw : std::nullopt, step.ratio()});
  }
  return plot;
}

Plot lengths_plot(const std::vector<FinishedDrive>& drives) {
  Plot plot{.name = "t_rel",
            .title = "Error of the end of a segment over its length (KITTI devkit, no alignment)",
            .x_label = "length of the segments (m)",
            .y_label = "t_rel (%)",
            .columns = {"length_m"},
            .rows = {},
            .curves = {},
            .settings = {"set xrange [0:900]", "set yrange [0:*]"}};
  for (const FinishedDrive& drive : drives) {
    plot.columns.push_back(drive.name);
    plot.curves.push_back({.title = drive.name,
                           .x = 0,
                           .y = static_cast<int>(plot.curves.size()) + 1,
                           .style = CurveStyle::kLinesPoints});
  }
  for (const double length_m : kitti_lengths_m()) {
    std::vector<std::optional<double>> row = {length_m};
    for (const FinishedDrive& drive : drives) row.push_back(drive.run.figure(fmt::format("t_rel_{:g}m", length_m)));
    if (std::any_of(row.begin() + 1, row.end(), [](const auto& value) { return value.has_value(); })) {
      plot.rows.push_back(std::move(row));
    }
  }
  return plot;
}

std::string processors(const std::vector<FinishedDrive>& drives) {
  std::vector<std::string> names;
  for (const FinishedDrive& drive : drives) names.push_back(drive.run.processor);
  return distinct(names);
}

std::string commands_section(const std::vector<FinishedDrive>& drives) {
  std::string text = "## Step by step\n\n";
  for (const FinishedDrive& drive : drives) {
    text += fmt::format("Drive {}:\n\n    {}\n    {}\n\n", drive.name, drive.drive.command,
                        fmt::join(drive.run.commands, "\n    "));
    std::vector<std::string> warnings;
    for (const std::string& warning : drive.run.warnings) warnings.push_back("warning: " + warning);
    text += bullet_list(warnings);
  }
  text.pop_back();
  return text;
}

}  // namespace

Table drives_table(const std::vector<FinishedDrive>& drives) {
  std::vector<Column> columns = first_columns();
  const std::vector<Column> figures = figure_columns();
  columns.insert(columns.end(), figures.begin(), figures.end());
  columns.push_back({.name = "processor", .title = "processor", .text = true});
  Table table(columns);
  for (const FinishedDrive& drive : drives) {
    std::vector<Cell> cells = first_cells(drive);
    for (const Column& column : figures) cells.emplace_back(drive.run.figure(column.name));
    cells.emplace_back(drive.run.processor);
    table.add_row(std::move(cells));
  }
  return table;
}

std::string drives_overview(const Table& table) {
  return table.markdown({"drive", "frames", "length_m", "raw_scale_bias", "raw_scale_spread", "scale_bias",
                         "scale_spread", "coverage", "t_rel", "r_rel", "median_ms", "peak_memory_mb"});
}

Result<std::vector<Plot>> drives_plots(const std::vector<FinishedDrive>& drives) {
  std::vector<Plot> plots;
  for (const FinishedDrive& drive : drives) {
    const auto paired = pair_drive({.estimate = drive.run.folder, .truth = drive.drive.truth()});
    if (!paired) return Error{ErrorCode::kIo, paired.error().message};
    const auto steps = compare_steps(paired->estimate, paired->truth);
    if (!steps) return Error{ErrorCode::kIo, steps.error().message};
    plots.push_back(path_plot(drive, *paired));
    plots.push_back(scale_plot(drive, *paired, *steps));
  }
  // Nothing to show where all drives are shorter than the shortest segment.
  Plot lengths = lengths_plot(drives);
  if (!lengths.rows.empty()) plots.push_back(std::move(lengths));
  return plots;
}

std::string drives_report(const std::vector<FinishedDrive>& drives, const std::vector<Plot>& plots,
                          const ExperimentRequest& request, const std::vector<std::string>& problems, bool drawn) {
  const Table table = drives_table(drives);
  std::string text = fmt::format("# Experiment `{}`: {}\n\n", kDrivesName, kDrivesSummary);
  text += fmt::format(
      "    {}\n\n{}. All figures with full precision are in `drives.csv`, under the names that "
      "docs/evaluation.md of groundscale defines.\nThe drives are simulated; scale is never aligned.\n\n",
      request.command, program_version());
  if (!problems.empty()) text += "**Not complete:**\n\n" + bullet_list(problems);
  text += "## Overview\n\n" + drives_overview(table);
  text +=
      "\nRaw: single measurements of the road that were accepted, against the true step. The others are of the final "
      "trajectory.\n\n";
  text += "## Single measurements\n\n" + table.markdown(scale_names("raw_")) + "\n";
  text +=
      "## Online trajectory: each step from frames up to its own\n\n" + table.markdown(scale_names("online_")) + "\n";
  text += "## Final trajectory\n\n" + table.markdown(scale_names("")) + "\n";
  text += table.markdown({"drive", "t_rel", "r_rel", "online_t_rel", "length_ratio", "rotation_error"}) + "\n";
  text += "## Time and memory\n\n" +
          table.markdown({"drive", "frames", "median_ms", "p95_ms", "wall_s", "peak_memory_mb"}) +
          fmt::format(
              "\nOf `groundscale run` as a process of its own; a frame with reading it; memory is the largest "
              "resident set. On: {}.\n\n",
              processors(drives));
  return text + figures_section(plots, drawn) + commands_section(drives);
}

}  // namespace groundscale::internal
