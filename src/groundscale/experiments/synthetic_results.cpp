#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>

#include "groundscale/core/check.hpp"
#include "groundscale/estimation/robust.hpp"
#include "groundscale/experiments/synthetic_results_internal.hpp"

namespace groundscale::internal {
namespace {

constexpr double kPercent = 100.0;
constexpr double kLowerQuartile = 0.25, kUpperQuartile = 0.75;

std::optional<std::size_t> find(const SyntheticResults& results, const std::string& method, double pitch_error_deg) {
  const auto& all = results.contenders;
  const auto found = std::find_if(all.begin(), all.end(), [&](const SyntheticContender& contender) {
    return contender.method == method && contender.pitch_error_deg == pitch_error_deg;
  });
  if (found == all.end()) return std::nullopt;
  return static_cast<std::size_t>(found - all.begin());
}

/// At how many noise levels something holds.
struct Count {
  int held = 0;
  int of = 0;
};

Count count_levels(const SyntheticResults& results, double above_px, const std::function<bool(std::size_t)>& holds) {
  Count count;
  for (std::size_t k = 0; k < results.noise_px.size(); ++k) {
    if (!(results.noise_px[k] > above_px)) continue;
    ++count.of;
    count.held += holds(k) ? 1 : 0;
  }
  return count;
}

PaperFinding judged(std::string what, const Count& count, const std::string& more = "") {
  PaperFinding finding{.what = std::move(what), .reproduced = {}, .measured = "no such noise level"};
  if (count.of == 0) return finding;
  finding.reproduced = count.held == count.of;
  finding.measured = fmt::format("at {} of {} noise levels{}", count.held, count.of, more);
  return finding;
}

PaperFinding missing(std::string what) {
  return {std::move(what), std::nullopt, "a method that it names is not measured"};
}

/// Mean over the noise levels above a bound of a contender's median.
double mean_error(const SyntheticResults& results, std::size_t setting, std::size_t contender, double above_px) {
  double sum = 0.0;
  int levels = 0;
  for (std::size_t k = 0; k < results.noise_px.size(); ++k) {
    if (!(results.noise_px[k] > above_px)) continue;
    sum += results.at(setting, k, contender).median();
    ++levels;
  }
  return levels > 0 ? sum / levels : 0.0;
}

/// That one contender is worse than another.
struct Comparison {
  std::string what;
  std::optional<std::size_t> worse, better;  ///< Contenders; nothing where one isn't measured.
  double above_px = 0.0;                     ///< At every noise level above this,
  double factor = 1.0;                       ///< by more than this factor.
};

PaperFinding judge(const SyntheticResults& results, std::size_t setting, const Comparison& comparison) {
  const std::string what = fmt::format("{} ({})", comparison.what, results.settings[setting].label());
  if (!comparison.worse || !comparison.better) return missing(what);
  const double above_px = comparison.above_px;
  const Count count = count_levels(results, above_px, [&](std::size_t level) {
    return results.at(setting, level, *comparison.worse).median() >
           comparison.factor * results.at(setting, level, *comparison.better).median();
  });
  const double ratio = mean_error(results, setting, *comparison.worse, above_px) /
                       mean_error(results, setting, *comparison.better, above_px);
  return judged(what, count, std::isfinite(ratio) ? fmt::format(", {:.2f} times the error on average", ratio) : "");
}

PaperFinding best(const SyntheticResults& results, std::size_t setting, std::string what, std::size_t contender) {
  what += fmt::format(" ({})", results.settings[setting].label());
  const std::string& own = results.contenders[contender].method;
  const Count count = count_levels(results, 0.0, [&](std::size_t level) {
    const double error = results.at(setting, level, contender).median();
    for (std::size_t other = 0; other < results.contenders.size(); ++other) {
      if (results.contenders[other].method == own) continue;
      if (results.at(setting, level, other).median() <= error) return false;
    }
    return true;
  });
  return judged(std::move(what), count);
}

/// A curve's name in the data.
std::string column_of(const SyntheticContender& contender) {
  return contender.pitch_error_deg == 0.0 ? contender.method
                                          : fmt::format("{}_{:+g}deg", contender.method, contender.pitch_error_deg);
}

std::optional<double> percent(double error) {
  return std::isfinite(error) ? std::optional(kPercent * error) : std::nullopt;
}

Plot plot_of(const SyntheticResults& results, std::size_t setting) {
  const SyntheticSetting& own = results.settings[setting];
  Plot plot{
      .name = fmt::format("scale-error-{:g}-kmh-{}-motion", own.speed_kmh, own.true_motion ? "true" : "estimated"),
      .title = fmt::format("Scale error, {}: median and quartiles", own.label()),
      .x_label = "noise on x2 (px)",
      .y_label = "|scale / true scale - 1| (%)",
      .columns = {"noise_px"},
      .rows = {},
      .curves = {}};
  std::vector<Curve> lines;
  for (std::size_t c = 0; c < results.contenders.size(); ++c) {
    const auto column = static_cast<int>(plot.columns.size());
    const std::string name = column_of(results.contenders[c]);
    plot.columns.insert(plot.columns.end(), {name, name + "_q25", name + "_q75"});
    const auto colour = static_cast<int>(c);
    plot.curves.push_back(
        {.title = "", .y = column + 1, .style = CurveStyle::kBand, .colour = colour, .y_high = column + 2});
    lines.push_back(
        {.title = results.contenders[c].label(), .y = column, .style = CurveStyle::kLinesPoints, .colour = colour});
  }
  plot.curves.insert(plot.curves.end(), lines.begin(), lines.end());
  for (std::size_t k = 0; k < results.noise_px.size(); ++k) {
    std::vector<std::optional<double>> row = {results.noise_px[k]};
    for (std::size_t c = 0; c < results.contenders.size(); ++c) {
      const SyntheticErrors& point = results.at(setting, k, c);
      for (const double fraction : {0.5, kLowerQuartile, kUpperQuartile}) {
        row.push_back(percent(fraction == 0.5 ? point.median() : point.quantile(fraction)));
      }
    }
    plot.rows.push_back(std::move(row));
  }
  return plot;
}

}  // namespace

std::string SyntheticContender::label() const {
  return pitch_error_deg == 0.0 ? method : fmt::format("{}, pitch {:+g} deg", method, pitch_error_deg);
}

std::string SyntheticSetting::label() const {
  return fmt::format("{:g} km/h, {} R, t", speed_kmh, true_motion ? "true" : "estimated");
}

double SyntheticErrors::quantile(double fraction) const { return groundscale::quantile(errors, fraction); }

/// Not the mean of the middle two, which may be a refusal and none.
double SyntheticErrors::median() const { return quantile(0.5); }

int SyntheticErrors::refused() const {
  return static_cast<int>(std::count_if(errors.begin(), errors.end(), [](double e) { return !std::isfinite(e); }));
}

const SyntheticErrors& SyntheticResults::at(std::size_t setting, std::size_t noise, std::size_t contender) const {
  const std::size_t index = (setting * noise_px.size() + noise) * contenders.size() + contender;
  GS_CHECK(index < points.size(), "a point of each setting, noise level and contender");
  return points[index];
}

Table synthetic_table(const SyntheticResults& results) {
  Table table({{.name = "speed_kmh", .title = "km/h", .decimals = 1},
               {.name = "motion", .title = "R, t", .text = true},
               {.name = "noise_px", .title = "noise px"},
               {.name = "method", .title = "method", .text = true},
               {.name = "pitch_error_deg", .title = "pitch off deg", .decimals = 1},
               {.name = "trials", .title = "trials", .decimals = 0},
               {.name = "refused", .title = "refused", .decimals = 0},
               {.name = "median", .title = "median %", .decimals = 3},
               {.name = "q25", .title = "25 % below %", .decimals = 3},
               {.name = "q75", .title = "75 % below %", .decimals = 3}});
  for (const SyntheticErrors& point : results.points) {
    table.add_row(
        {std::optional(point.setting.speed_kmh), std::string(point.setting.true_motion ? "true" : "estimated"),
         std::optional(point.noise_px), point.contender.method, std::optional(point.contender.pitch_error_deg),
         std::optional(static_cast<double>(point.errors.size())), std::optional(static_cast<double>(point.refused())),
         percent(point.median()), percent(point.quantile(kLowerQuartile)), percent(point.quantile(kUpperQuartile))});
  }
  return table;
}

std::string synthetic_overview(const SyntheticResults& results, std::size_t setting) {
  std::vector<Column> columns = {{.name = "noise_px", .title = "noise px", .averaged = false}};
  for (const SyntheticContender& contender : results.contenders) {
    columns.push_back({.name = contender.label(), .title = contender.label() + " %"});
  }
  std::vector<std::string> names;
  for (const Column& column : columns) names.push_back(column.name);
  Table table(columns);
  for (std::size_t k = 0; k < results.noise_px.size(); ++k) {
    std::vector<Cell> cells = {std::optional(results.noise_px[k])};
    for (std::size_t c = 0; c < results.contenders.size(); ++c) {
      cells.emplace_back(percent(results.at(setting, k, c).median()));
    }
    table.add_row(std::move(cells));
  }
  return table.markdown(names);
}

std::vector<Plot> synthetic_plots(const SyntheticResults& results) {
  std::vector<Plot> plots;
  for (std::size_t setting = 0; setting < results.settings.size(); ++setting) {
    plots.push_back(plot_of(results, setting));
  }
  return plots;
}

std::vector<PaperFinding> synthetic_findings(const SyntheticResults& results) {
  constexpr double kFar = 2.0;
  constexpr double kBeyondPx = 1.0;
  const auto sparse = find(results, "sparse", 0.0);
  const auto& settings = results.settings;
  const auto by_speed = [](const SyntheticSetting& a, const SyntheticSetting& b) { return a.speed_kmh < b.speed_kmh; };
  const auto [slowest, fastest] = std::minmax_element(settings.begin(), settings.end(), by_speed);
  std::vector<std::size_t> triangulations;
  for (std::size_t c = 0; c < results.contenders.size(); ++c) {
    if (results.contenders[c].method == "triangulation") triangulations.push_back(c);
  }

  std::vector<PaperFinding> findings;
  const auto worse_everywhere = [&](const std::string& method) {
    for (std::size_t k = 0; k < settings.size(); ++k) {
      findings.push_back(
          judge(results, k,
                {.what = method + " is worse than sparse", .worse = find(results, method, 0.0), .better = sparse}));
    }
  };
  worse_everywhere("decomposition");
  if (triangulations.empty()) findings.push_back(missing("triangulation is best at high speed"));
  for (std::size_t k = 0; k < settings.size(); ++k) {
    for (const std::size_t c : triangulations) {
      if (settings[k].speed_kmh != fastest->speed_kmh) continue;
      findings.push_back(best(results, k, results.contenders[c].label() + " is best at high speed", c));
    }
  }
  if (triangulations.empty()) findings.push_back(missing("triangulation has twice the error of sparse beyond 1 px"));
  for (std::size_t k = 0; k < settings.size(); ++k) {
    for (const std::size_t c : triangulations) {
      if (settings[k].speed_kmh != slowest->speed_kmh) continue;
      const std::string what = results.contenders[c].label() + " has twice the error of sparse beyond 1 px";
      findings.push_back(
          judge(results, k, {.what = what, .worse = c, .better = sparse, .above_px = kBeyondPx, .factor = kFar}));
    }
  }
  worse_everywhere("joint");
  return findings;
}

}  // namespace groundscale::internal
