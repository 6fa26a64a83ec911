#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "groundscale/experiments/contest_report_internal.hpp"
#include "groundscale/experiments/path_plots.hpp"
#include "groundscale/experiments/report_parts.hpp"

namespace groundscale::internal {
namespace {

Column figure_column(const std::string& name, const std::string& title, int decimals, bool sign = false) {
  return {.name = name, .title = title, .decimals = decimals, .sign = sign, .averaged = false};
}

/// Figures of every trajectory.
std::vector<Column> figure_columns() {
  return {figure_column("t_rel", "t_rel %", 3),
          figure_column("r_rel", "r_rel deg/100 m", 3),
          figure_column("t_rel_50m", "t_rel, 50 m %", 3),
          figure_column("r_rel_50m", "r_rel, 50 m deg/100 m", 3),
          figure_column("ate_se3", "ATE, se3 m", 2),
          figure_column("ate_sim3", "ATE, sim3 m", 2),
          figure_column("sim3_scale", "sim3 scale", 4),
          figure_column("scale_bias", "scale bias %", 2, true),
          figure_column("scale_spread", "scale spread %", 2),
          figure_column("scale_drift", "scale drift % per 100 m", 2, true),
          figure_column("online_t_rel", "online t_rel %", 3),
          figure_column("coverage", "coverage %", 1)};
}

/// What our own runs have besides.
std::vector<Column> run_columns() {
  return {figure_column("corrections", "corrections", 0), figure_column("lost", "frames lost", 0),
          figure_column("median_ms", "ms a frame", 1), figure_column("p95_ms", "95 % below ms", 1),
          figure_column("peak_memory_mb", "memory MB", 0)};
}

std::vector<std::optional<double>> run_values(const Contender& contender) {
  if (!contender.run) return std::vector<std::optional<double>>(run_columns().size());
  const MeasuredRun& run = *contender.run;
  return {run.corrections, run.lost, run.median_ms, run.p95_ms, run.peak_memory_mb};
}

std::vector<std::optional<double>> all_values(const Contender& contender) {
  std::vector<std::optional<double>> values;
  for (const Column& column : figure_columns()) values.push_back(contender.figure(column.name));
  for (const auto& value : run_values(contender)) values.push_back(value);
  return values;
}

std::vector<std::string> labels_of(const std::vector<ContestedDrive>& drives) {
  std::vector<std::string> labels;
  for (const ContestedDrive& drive : drives) {
    for (const Contender& contender : drive.contenders) {
      if (std::find(labels.begin(), labels.end(), contender.label) == labels.end()) labels.push_back(contender.label);
    }
  }
  return labels;
}

/// Plain means of a label's figures over the drives that have a value.
std::vector<Cell> mean_row(const std::vector<ContestedDrive>& drives, const std::string& label) {
  const std::size_t columns = figure_columns().size() + run_columns().size();
  std::vector<double> sums(columns, 0.0);
  std::vector<int> counts(columns, 0);
  int of = 0;
  for (const ContestedDrive& drive : drives) {
    const Contender* contender = drive.find(label);
    if (contender == nullptr) continue;
    ++of;
    const auto values = all_values(*contender);
    for (std::size_t k = 0; k < columns; ++k) {
      if (!values[k]) continue;
      sums[k] += *values[k];
      ++counts[k];
    }
  }
  std::vector<Cell> cells = {fmt::format("mean of {}", of), std::string(), std::optional<double>(),
                             std::optional<double>(), label};
  for (std::size_t k = 0; k < columns; ++k) {
    cells.emplace_back(counts[k] > 0 ? std::optional(sums[k] / counts[k]) : std::nullopt);
  }
  return cells;
}

/// A curve's name in the data: without blanks and the like.
std::string column_of(const std::string& label) {
  std::string column = label;
  for (char& c : column) {
    if (c == ' ' || c == ',' || c == '(' || c == ')') c = '_';
  }
  return column;
}

Plot scale_plot(const ContestedDrive& drive) {
  Plot plot{.name = "scale-" + drive.name,
            .title = fmt::format("Drive {}: length of pieces of 20 m over the true one", drive.name),
            .x_label = "true distance (m)",
            .y_label = "estimated / true length",
            .columns = {"distance_m"},
            .rows = {},
            .curves = {}};
  std::size_t pieces = 0;
  for (const Contender& contender : drive.contenders) {
    pieces = std::max(pieces, contender.measures.pieces.size());
    const auto column = static_cast<int>(plot.columns.size());
    plot.curves.push_back({.title = contender.label, .x = 0, .y = column, .colour = column});
    plot.columns.push_back(column_of(contender.label));
  }
  if (pieces < 2) return plot;  // no line
  for (std::size_t k = 0; k < pieces; ++k) {
    std::vector<std::optional<double>> row = {std::nullopt};
    for (const Contender& contender : drive.contenders) {
      const auto& own = contender.measures.pieces;
      if (k < own.size()) row.front() = own[k].distance_m;  // pieces end where the truth says: the same for all
      row.push_back(k < own.size() ? std::optional(own[k].ratio) : std::nullopt);
    }
    plot.rows.push_back(std::move(row));
  }
  return plot;
}

std::string seeds_section(const SeedRuns& seeds) {
  if (seeds.runs.empty()) return "";
  const Table table = seeds_table(seeds);
  std::string text = fmt::format("## Seeds: `{}` on {}\n\n{}\n", seeds.mode, seeds.drive,
                                 table.markdown({"seed", "t_rel", "r_rel", "t_rel_50m", "ate_se3", "scale_bias"}));
  for (const char* name : {"t_rel", "t_rel_50m"}) {
    std::vector<double> values;
    for (const Contender& run : seeds.runs) {
      if (const auto value = run.figure(name)) values.push_back(*value);
    }
    if (values.size() < 2) continue;
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const auto count = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
    double squares = 0.0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    text += fmt::format("- {}: {:.3f} to {:.3f} %, sd {:.3f} %\n", name, *low, *high, std::sqrt(squares / (count - 1)));
  }
  if (seeds.same_bytes) {
    text += fmt::format("- the same seed a second time gives {}\n",
                        *seeds.same_bytes ? "the same bytes (trajectory.kitti, frames.csv)" : "**other bytes**");
  }
  return text + "\n";
}

std::string commands_section(const std::vector<ContestedDrive>& drives) {
  std::string text = "## Step by step\n\n";
  for (const ContestedDrive& drive : drives) {
    text += drive.drive.command.empty() ? fmt::format("Drive {}, in {}:\n\n", drive.name, drive.drive.folder)
                                        : fmt::format("Drive {}:\n\n    {}\n", drive.name, drive.drive.command);
    std::vector<std::string> warnings;
    for (const Contender& contender : drive.contenders) {
      if (!contender.run) continue;
      text += fmt::format("    {}\n", fmt::join(contender.run->commands, "\n    "));
      for (const std::string& warning : contender.run->warnings) {
        warnings.push_back(fmt::format("{}: warning: {}", contender.label, warning));
      }
    }
    text.append("\n").append(bullet_list(warnings));
  }
  text.pop_back();
  return text;
}

std::string remarks_of(const ContestResult& result) {
  std::vector<std::string> remarks = result.remarks;
  for (const ContestedDrive& drive : result.drives) {
    for (const Contender& contender : drive.contenders) {
      if (contender.remark.empty()) continue;
      remarks.push_back(fmt::format("{} on {}: {}", contender.label, drive.name, contender.remark));
    }
  }
  return bullet_list(remarks);
}

std::string processors(const std::vector<ContestedDrive>& drives) {
  std::vector<std::string> names;
  for (const ContestedDrive& drive : drives) {
    for (const Contender& contender : drive.contenders) {
      if (contender.run) names.push_back(contender.run->processor);
    }
  }
  return distinct(names);
}

}  // namespace

Table contest_table(const std::vector<ContestedDrive>& drives) {
  std::vector<Column> columns = {{.name = "sequence", .title = "sequence", .text = true},
                                 {.name = "source", .title = "source", .text = true},
                                 figure_column("frames", "frames", 0),
                                 figure_column("length_m", "length m", 0),
                                 {.name = "mode", .title = "mode", .text = true}};
  for (const auto& more : {figure_columns(), run_columns()}) columns.insert(columns.end(), more.begin(), more.end());
  Table table(columns);
  for (const ContestedDrive& drive : drives) {
    std::optional<double> length_m;
    for (const Contender& contender : drive.contenders) {
      if (contender.run) length_m = contender.run->length_m;
    }
    for (const Contender& contender : drive.contenders) {
      std::vector<Cell> cells = {drive.name, std::string(drive.drive.real ? "real" : "simulated"),
                                 std::optional<double>(drive.truth.size()), length_m, contender.label};
      for (const auto& value : all_values(contender)) cells.emplace_back(value);
      table.add_row(std::move(cells));
    }
  }
  if (drives.size() < 2) return table;
  for (const std::string& label : labels_of(drives)) table.add_row(mean_row(drives, label));
  return table;
}

Table seeds_table(const SeedRuns& seeds) {
  std::vector<Column> columns = {{.name = "seed", .title = "seed", .text = true}};
  for (const auto& more : {figure_columns(), run_columns()}) columns.insert(columns.end(), more.begin(), more.end());
  Table table(columns);
  for (const Contender& run : seeds.runs) {
    std::vector<Cell> cells = {run.label};
    for (const auto& value : all_values(run)) cells.emplace_back(value);
    table.add_row(std::move(cells));
  }
  return table;
}

std::string contest_overview(const Table& table) {
  return table.markdown({"sequence", "source", "frames", "mode", "t_rel", "r_rel", "ate_se3", "ate_sim3", "sim3_scale",
                         "scale_bias", "scale_spread", "scale_drift", "coverage", "corrections", "lost", "median_ms"});
}

std::vector<Plot> contest_plots(const std::vector<ContestedDrive>& drives) {
  std::vector<Plot> plots;
  for (const ContestedDrive& drive : drives) {
    std::vector<PlottedPath> paths = {{{"truth", "truth"}, drive.truth}};
    std::vector<PlottedErrors> errors;
    for (const Contender& contender : drive.contenders) {
      const CurveName name{column_of(contender.label), contender.label};
      paths.push_back({name, contender.measures.path});
      errors.push_back({name, contender.measures.by_length});
    }
    plots.push_back(trajectory_plot(drive.name, paths));
    for (const PathError error : {PathError::kTranslation, PathError::kRotation}) {
      // Nothing to show where the drive is shorter than the shortest segment.
      Plot plot = length_plot(drive.name, error, errors);
      if (!plot.rows.empty()) plots.push_back(std::move(plot));
    }
    Plot scale = scale_plot(drive);
    if (!scale.rows.empty()) plots.push_back(std::move(scale));
  }
  return plots;
}

std::string contest_report(const Contest& contest, const ContestResult& result, const std::vector<Plot>& plots,
                           const ExperimentRequest& request, bool drawn) {
  const Table table = contest_table(result.drives);
  std::string text = fmt::format("# Experiment `{}`: {}\n\n", contest.name, contest.summary);
  text += fmt::format(
      "    {}\n\n{}. All figures with full precision are in `{}.csv`, under the names that docs/evaluation.md of "
      "groundscale defines.\nScale is never aligned but where the name says sim3. The truth is that of the drive.\n\n",
      request.command, program_version(), contest.name);
  if (!result.problems.empty()) text += "**Not complete:**\n\n" + bullet_list(result.problems);
  std::vector<std::string> aims;
  for (const Aim& aim : result.aims) aims.push_back(in_words(aim));
  if (!aims.empty()) text += "## Aims\n\n" + bullet_list(aims);
  text += "## Overview\n\n" + contest_overview(table) + "\n" + remarks_of(result);
  text += "## More figures\n\n" +
          table.markdown(
              {"sequence", "mode", "length_m", "t_rel_50m", "r_rel_50m", "online_t_rel", "p95_ms", "peak_memory_mb"}) +
          fmt::format("\nTimes and memory are those of `groundscale run` on: {}.\n\n", processors(result.drives));
  text += seeds_section(result.seeds);
  return text + figures_section(plots, drawn) + commands_section(result.drives);
}

}  // namespace groundscale::internal
