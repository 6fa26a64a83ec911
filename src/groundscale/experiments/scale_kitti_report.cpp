#include <algorithm>

#include <fmt/format.h>

#include "groundscale/experiments/report_parts.hpp"
#include "groundscale/experiments/scale_kitti_report_internal.hpp"

namespace groundscale::internal {
namespace {

constexpr double kPercent = 100.0;

std::vector<ScaleSetting> settings_of(const std::vector<ScaleRow>& rows) {
  std::vector<ScaleSetting> settings;
  for (const char* region : {"fixed", "path"}) {
    for (const char* filter : {"none", "paper", "model"}) {
      const ScaleSetting setting{region, filter};
      const auto has = [&setting](const ScaleRow& row) { return row.setting == setting; };
      if (std::any_of(rows.begin(), rows.end(), has)) settings.push_back(setting);
    }
  }
  return settings;
}

std::vector<std::string> methods_of(const std::vector<ScaleRow>& rows) {
  std::vector<std::string> methods;
  for (const ScaleRow& row : rows) {
    if (std::find(methods.begin(), methods.end(), row.method) == methods.end()) methods.push_back(row.method);
  }
  return methods;
}

const ScaleRow* find(const std::vector<ScaleRow>& rows, const std::string& drive, const ScaleSetting& setting,
                     const std::string& method) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const ScaleRow& row) {
    return row.drive == drive && row.setting == setting && row.method == method;
  });
  return found == rows.end() ? nullptr : &*found;
}

std::optional<double> mean_error(const ScaleRow* row) {
  return row != nullptr && row->scale.all ? std::optional(kPercent * row->scale.all->mean) : std::nullopt;
}

std::string in_words(const ScaleSetting& setting) {
  const char* region = setting.region == "fixed" ? "fixed region" : "region along the path";
  const char* filter = setting.filter == "none"    ? "without a filter"
                       : setting.filter == "paper" ? "the paper's filter"
                                                   : "our filter";
  return fmt::format("{}, {}", region, filter);
}

Column figure_column(const std::string& name, const std::string& title, bool sign = false) {
  return {.name = name, .title = title, .decimals = 2, .sign = sign, .averaged = false};
}

void add_errors(const std::optional<ScaleErrors>& errors, std::vector<Cell>& cells) {
  using Value = std::optional<double>;
  cells.emplace_back(errors ? Value(kPercent * errors->mean) : Value());
  cells.emplace_back(errors ? Value(kPercent * errors->bias) : Value());
  cells.emplace_back(errors ? Value(kPercent * errors->spread) : Value());
  cells.emplace_back(errors ? Value(kPercent * errors->p95) : Value());
}

}  // namespace

Table scale_table(const std::vector<ScaleRow>& rows) {
  std::vector<Column> columns;
  for (const char* name : {"sequence", "source", "region", "filter", "method"}) {
    columns.push_back({.name = name, .title = name, .text = true});
  }
  columns.push_back(figure_column("coverage", "coverage %"));
  for (const auto& [part, of] :
       {std::pair("", ""), std::pair("_straight", ", straights"), std::pair("_turn", ", turns")}) {
    const auto column = [&, part = part, of = of](const char* name, const char* title, bool sign = false) {
      columns.push_back(figure_column(fmt::format("{}{}", name, part), fmt::format("{}{} %", title, of), sign));
    };
    column("scale_error_mean", "mean error");
    column("scale_bias", "bias", true);
    column("scale_spread", "spread");
    column("scale_error_p95", "95 % below");
  }
  columns.push_back(figure_column("time_ms", "ms"));
  Table table(columns);
  for (const ScaleRow& row : rows) {
    std::vector<Cell> cells = {row.drive, std::string(row.real ? "real" : "simulated"), row.setting.region,
                               row.setting.filter, row.method};
    cells.emplace_back(row.coverage ? std::optional(kPercent * *row.coverage) : std::nullopt);
    for (const auto& errors : {row.scale.all, row.scale.straight, row.scale.turn}) add_errors(errors, cells);
    cells.emplace_back(row.time_ms);
    table.add_row(std::move(cells));
  }
  return table;
}

std::string scale_overview(const ScaleKittiResult& result) {
  std::string text;
  for (const ScaleSetting& setting : settings_of(result.rows)) {
    std::vector<Column> columns = {{.name = "method", .title = "method", .text = true}};
    std::vector<std::string> names = {"method"};
    for (const RenderedDrive& drive : result.drives) {
      columns.push_back(figure_column(drive.name, fmt::format("{}{}", drive.name, drive.real ? "" : " (simulated)")));
      names.push_back(drive.name);
    }
    Table table(columns);
    for (const std::string& method : methods_of(result.rows)) {
      std::vector<Cell> cells = {method};
      for (const RenderedDrive& drive : result.drives) {
        cells.emplace_back(mean_error(find(result.rows, drive.name, setting, method)));
      }
      table.add_row(std::move(cells));
    }
    text += fmt::format("Mean scale error in %, {}:\n\n{}\n", in_words(setting), table.markdown(names));
  }
  return text;
}

std::vector<Plot> scale_plots(const ScaleKittiResult& result) {
  std::string tics;
  for (std::size_t k = 0; k < result.drives.size(); ++k) {
    const RenderedDrive& drive = result.drives[k];
    tics += fmt::format("{}\"{}{}\" {}", k == 0 ? "" : ", ", drive.name, drive.real ? "" : "*", k);
  }
  std::vector<Plot> plots;
  for (const ScaleSetting& setting : settings_of(result.rows)) {
    Plot plot{.name = fmt::format("scale-{}-{}", setting.region, setting.filter),
              .title = fmt::format("Mean scale error: {}", in_words(setting)),
              .x_label = "sequence (* simulated)",
              .y_label = "mean |estimated / true step - 1| (%)",
              .columns = {"sequence"},
              .rows = {},
              .curves = {}};
    plot.settings = {fmt::format("set xtics ({})", tics), "set logscale y",
                     fmt::format("set xrange [-0.5:{}]", static_cast<double>(result.drives.size()) - 0.5)};
    for (const std::string& method : methods_of(result.rows)) {
      plot.curves.push_back({.title = method,
                             .x = 0,
                             .y = static_cast<int>(plot.columns.size()),
                             .style = CurveStyle::kLinesPoints,
                             .colour = static_cast<int>(plot.columns.size())});
      plot.columns.push_back(method);
    }
    for (std::size_t k = 0; k < result.drives.size(); ++k) {
      std::vector<std::optional<double>> row = {static_cast<double>(k)};
      for (const std::string& method : methods_of(result.rows)) {
        row.push_back(mean_error(find(result.rows, result.drives[k].name, setting, method)));
      }
      plot.rows.push_back(std::move(row));
    }
    plots.push_back(std::move(plot));
  }
  return plots;
}

std::string scale_kitti_report(const ScaleKittiResult& result, const std::vector<Plot>& plots,
                               const ExperimentRequest& request, bool drawn) {
  const Table table = scale_table(result.rows);
  std::string text = fmt::format(
      "# Experiment `scale-kitti`: scale errors of every way to measure the ground\n\n    {}\n\n{}, {}. All figures "
      "are "
      "in `scale-kitti.csv` with full precision. Each method has the same matches and motions on a drive and region; "
      "error = |estimated / true step - 1| over the moving steps, of accepted measurements without a filter, of all "
      "online steps with one. In the paper's filter triangulation, decomposition, delaunay and fixed_plane have the "
      "scale alone filtered, the others normal and height.\n\n",
      request.command, program_version(), processor_name());
  if (!result.problems.empty()) text += "**Not complete:**\n\n" + bullet_list(result.problems);
  text += "## Mean scale error\n\n" + scale_overview(result);
  text += "## More figures\n\n" +
          table.markdown({"sequence", "source", "region", "filter", "method", "coverage", "scale_bias", "scale_spread",
                          "scale_error_p95", "scale_bias_straight", "scale_spread_straight", "scale_error_p95_straight",
                          "scale_bias_turn", "scale_spread_turn", "scale_error_p95_turn", "time_ms"});
  text += fmt::format("\n{}## Step by step\n\n", figures_section(plots, drawn));
  for (const RenderedDrive& drive : result.drives) {
    if (!drive.command.empty()) text += fmt::format("    {}\n", drive.command);
  }
  for (const std::string& command : result.commands) text += fmt::format("    {}\n", command);
  return text;
}

}  // namespace groundscale::internal
