#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/experiments/contamination_records_internal.hpp"

namespace groundscale::internal {
namespace {

constexpr double kPercent = 100.0;

/// Records of one region, share and method.
struct Group {
  std::vector<double> errors;  ///< Of those that are measured.
  std::vector<double> shares;
  int pairs = 0;

  std::optional<double> of(double fraction, bool absolute) const {
    std::vector<double> values = errors;
    if (absolute) std::transform(values.begin(), values.end(), values.begin(), [](double e) { return std::abs(e); });
    if (values.empty()) return std::nullopt;
    return kPercent * (fraction == 0.5 ? median(values) : quantile(values, fraction));
  }
};

Group group_of(const std::vector<ContaminationRecord>& records, std::string_view region, double share,
               const std::string& method) {
  Group group;
  for (const ContaminationRecord& record : records) {
    if (record.region != region || record.wanted_share != share || record.method != method) continue;
    ++group.pairs;
    group.shares.push_back(record.share);
    if (record.error) group.errors.push_back(*record.error);
  }
  return group;
}

std::vector<double> shares_of(const std::vector<ContaminationRecord>& records) {
  std::vector<double> shares;
  for (const ContaminationRecord& record : records) shares.push_back(record.wanted_share);
  std::sort(shares.begin(), shares.end());
  shares.erase(std::unique(shares.begin(), shares.end()), shares.end());
  return shares;
}

std::vector<std::string> methods_of(const std::vector<ContaminationRecord>& records) {
  std::vector<std::string> methods;
  for (const ContaminationRecord& record : records) {
    if (std::find(methods.begin(), methods.end(), record.method) == methods.end()) methods.push_back(record.method);
  }
  return methods;
}

constexpr std::string_view kRegions[] = {kWholeRegion, kPathRegion, kRoadMask};

std::string in_words(std::string_view region) {
  if (region == kWholeRegion) return "whole region";
  return region == kPathRegion ? "region along the path" : "road mask";
}

}  // namespace

Table records_table(const std::vector<ContaminationRecord>& records) {
  Table table({{.name = "drive", .title = "drive", .text = true},
               {.name = "frame", .title = "frame", .decimals = 0},
               {.name = "region", .title = "region", .text = true},
               {.name = "share", .title = "share %", .decimals = 0},
               {.name = "region_share", .title = "of the region %"},
               {.name = "method", .title = "method", .text = true},
               {.name = "error", .title = "error %", .sign = true}});
  for (const ContaminationRecord& r : records) {
    table.add_row({r.drive, std::optional<double>(r.frame), r.region, std::optional(kPercent * r.wanted_share),
                   std::optional(kPercent * r.share), r.method,
                   r.error ? std::optional(kPercent * *r.error) : std::nullopt});
  }
  return table;
}

Table contamination_table(const std::vector<ContaminationRecord>& records) {
  Table table({{.name = "region", .title = "region", .text = true},
               {.name = "share", .title = "share %", .decimals = 0, .averaged = false},
               {.name = "region_share", .title = "not road %", .decimals = 1, .averaged = false},
               {.name = "method", .title = "method", .text = true},
               {.name = "pairs", .title = "pairs", .decimals = 0, .averaged = false},
               {.name = "coverage", .title = "coverage %", .decimals = 1, .averaged = false},
               {.name = "bias", .title = "bias %", .sign = true, .averaged = false},
               {.name = "median", .title = "median %", .averaged = false},
               {.name = "p95", .title = "p95 %", .averaged = false}});
  constexpr double kHigh = 0.95;
  for (const std::string_view region : kRegions) {
    for (const double share : shares_of(records)) {
      for (const std::string& method : methods_of(records)) {
        const Group group = group_of(records, region, share, method);
        if (group.pairs == 0) continue;
        table.add_row({std::string(region), std::optional(kPercent * share),
                       std::optional(kPercent * median(group.shares)), method, std::optional<double>(group.pairs),
                       std::optional(kPercent * static_cast<double>(group.errors.size()) / group.pairs),
                       group.of(0.5, false), group.of(0.5, true), group.of(kHigh, true)});
      }
    }
  }
  return table;
}

std::string contamination_overview(const std::vector<ContaminationRecord>& records, std::string_view region) {
  std::vector<Column> columns = {{.name = "share", .title = "share %", .decimals = 0, .averaged = false},
                                 {.name = "pairs", .title = "pairs", .decimals = 0, .averaged = false}};
  const std::vector<std::string> methods = methods_of(records);
  for (const std::string& method : methods) {
    columns.push_back({.name = method, .title = method, .averaged = false});
  }
  std::vector<std::string> names;
  for (const Column& column : columns) names.push_back(column.name);
  Table table(columns);
  for (const double share : shares_of(records)) {
    std::vector<Cell> cells = {std::optional(kPercent * share),
                               std::optional<double>(group_of(records, region, share, methods.front()).pairs)};
    for (const std::string& method : methods)
      cells.emplace_back(group_of(records, region, share, method).of(0.5, true));
    table.add_row(std::move(cells));
  }
  return fmt::format("{}, median of |error| in %:\n\n{}", in_words(region), table.markdown(names));
}

std::vector<Plot> contamination_plots(const std::vector<ContaminationRecord>& records) {
  std::vector<Plot> plots;
  const std::vector<std::string> methods = methods_of(records);
  for (const std::string_view region : kRegions) {
    Plot plot{.name = fmt::format("error-{}", region),
              .title = fmt::format("Scale error, {}: median", in_words(region)),
              .x_label = "share of the fixed region that isn't road (%)",
              .y_label = "|step / true step - 1| (%)",
              .columns = {"share"},
              .rows = {},
              .curves = {},
              // One scale for 1 % and 100 %.
              .settings = {"set logscale y"}};
    for (const std::string& method : methods) {
      const auto column = static_cast<int>(plot.columns.size());
      plot.curves.push_back({.title = method, .y = column, .style = CurveStyle::kLinesPoints});
      plot.columns.push_back(method);
    }
    for (const double share : shares_of(records)) {
      std::vector<std::optional<double>> row = {kPercent * share};
      for (const std::string& method : methods) {
        row.push_back(group_of(records, region, share, method).of(0.5, true));
      }
      plot.rows.push_back(std::move(row));
    }
    plots.push_back(std::move(plot));
  }
  return plots;
}

}  // namespace groundscale::internal
