#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/report/calibration_figures_internal.hpp"
#include "groundscale/report/chart_internal.hpp"
#include "groundscale/report/markup_internal.hpp"

namespace groundscale::internal {
namespace {

/// An arrow about a place, as long as the vector; a dot where that is too short to be seen.
std::string arrow(const Eigen::Vector2d& middle, const Eigen::Vector2d& vector) {
  const double length = vector.norm();
  constexpr double kShortest = 2.0;
  if (length < kShortest) {
    return fmt::format("<circle class=\"arrow\" cx=\"{}\" cy=\"{}\" r=\"0.8\"/>", coordinate(middle.x()),
                       coordinate(middle.y()));
  }
  const Eigen::Vector2d tail = middle - 0.5 * vector;
  const Eigen::Vector2d tip = middle + 0.5 * vector;
  const Eigen::Vector2d along = vector / length;
  const Eigen::Vector2d across(-along.y(), along.x());
  const double head = std::min(9.0, 0.5 * length);
  const Eigen::Vector2d left = tip - head * (along - 0.4 * across);
  const Eigen::Vector2d right = tip - head * (along + 0.4 * across);
  const auto place = [](const Eigen::Vector2d& p) { return coordinate(p.x()) + " " + coordinate(p.y()); };
  return fmt::format("<path class=\"arrow\" d=\"M{}L{}M{}L{}L{}Z\"/>", place(tail), place(tip), place(tip), place(left),
                     place(right));
}

std::string_view colour_of(const ResidualMap::Cell& cell, const MapScale& scale) {
  if (cell.count < kLeastResiduals) return kLeftOutColour;
  const double steps = std::floor(cell.mean_px().norm() / scale.colour_step_px);
  return kResidualColours[static_cast<std::size_t>(std::min(steps, kResidualColours.size() - 1.0))];
}

double percent(double log_ratio) { return 100.0 * std::expm1(log_ratio); }

double line_at(const ScaleSlope& slope, double distance_m) {
  return percent(slope.level + slope.per_100m * distance_m / 100.0);
}

bool is_finite(const ScaleSlope::Sample& sample) {
  return std::isfinite(sample.distance_m) && std::isfinite(sample.log_ratio);
}

/// From zero to the lines, and as far to both sides of them as measurements commonly lie.
Plot slope_plot(const std::vector<const ScaleSlope*>& slopes) {
  Plot plot;
  plot.height = 340.0;
  double low = 0.0;
  double high = 0.0;
  double length_m = 1.0;
  const auto take_in = [&low, &high](double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  };
  for (const ScaleSlope* slope : slopes) {
    std::vector<double> errors;
    for (const ScaleSlope::Sample& sample : slope->samples) {
      if (!is_finite(sample)) continue;
      errors.push_back(std::abs(percent(sample.log_ratio) - line_at(*slope, sample.distance_m)));
      length_m = std::max(length_m, sample.distance_m);
    }
    if (errors.empty()) continue;
    constexpr double kMedians = 4.0;  // 2.7 sd of normal errors
    const double beside = kMedians * median(std::move(errors));
    for (const double distance_m : {slope->samples.front().distance_m, slope->samples.back().distance_m}) {
      take_in(line_at(*slope, distance_m) - beside);
      take_in(line_at(*slope, distance_m) + beside);
    }
  }
  constexpr double kLeastPercent = 0.5;
  const double margin = std::max(kLeastPercent, 0.05 * (high - low));
  plot.high_x = length_m;
  plot.bottom_y = low - margin;
  plot.top_y = high + margin;
  return plot;
}

std::string mark(SlopeSeries series, double x, double y) {
  if (series == SlopeSeries::kBefore) {
    return fmt::format("<circle class=\"before\" cx=\"{}\" cy=\"{}\" r=\"3\"/>\n", coordinate(x), coordinate(y));
  }
  return fmt::format("<rect class=\"after\" x=\"{}\" y=\"{}\" width=\"4\" height=\"4\"/>\n", coordinate(x - 2.0),
                     coordinate(y - 2.0));
}

std::string marks(const ScaleSlope& slope, SlopeSeries series, const Plot& plot, SlopeFigure& figure) {
  std::vector<const ScaleSlope::Sample*> inside;
  for (const ScaleSlope::Sample& sample : slope.samples) {
    const double value = is_finite(sample) ? percent(sample.log_ratio) : plot.top_y + 1.0;
    if (value >= plot.bottom_y && value <= plot.top_y) inside.push_back(&sample);
  }
  figure.within += static_cast<int>(inside.size());
  figure.outside += static_cast<int>(slope.samples.size() - inside.size());
  constexpr std::size_t kMost = 250;
  const std::size_t every = std::max<std::size_t>(1, (inside.size() + kMost - 1) / kMost);
  std::string svg;
  for (std::size_t k = 0; k < inside.size(); k += every) {
    svg += mark(series, plot.x(inside[k]->distance_m), plot.y(percent(inside[k]->log_ratio)));
    ++figure.drawn;
  }
  return svg;
}

std::string fitted_line(const ScaleSlope& slope, SlopeSeries series, const Plot& plot) {
  if (slope.samples.empty() || !std::isfinite(slope.level) || !std::isfinite(slope.per_100m)) return "";
  const double from_m = slope.samples.front().distance_m;
  const double to_m = slope.samples.back().distance_m;
  std::string points;
  constexpr int kPieces = 24;  // straight in the log, a little bent in percent
  for (int k = 0; k <= kPieces; ++k) {
    const double distance_m = from_m + (to_m - from_m) * k / kPieces;
    points += fmt::format("{}{},{}", k > 0 ? " " : "", coordinate(plot.x(distance_m)),
                          coordinate(plot.y(line_at(slope, distance_m))));
  }
  return fmt::format("<polyline class=\"{}\" points=\"{}\"/>\n",
                     series == SlopeSeries::kBefore ? "before-line" : "after-line", points);
}

}  // namespace

MapScale common_scale(const std::vector<const ResidualMap*>& maps) {
  double longest_px = 0.0;
  double cell_px = 1.0;
  for (const ResidualMap* map : maps) {
    cell_px = std::min(static_cast<double>(map->width) / map->columns, static_cast<double>(map->height) / map->rows);
    for (const ResidualMap::Cell& cell : map->cells) {
      if (cell.count >= kLeastResiduals) longest_px = std::max(longest_px, cell.mean_px().norm());
    }
  }
  if (!(longest_px > 0.0)) return {};
  return {round_down(cell_px / longest_px), round_up(longest_px / static_cast<double>(kResidualColours.size()))};
}

std::string residual_map_svg(const ResidualMap& map, const MapScale& scale, std::string_view name) {
  Plot plot;
  constexpr double kHighest = 700.0;
  const double unit = std::min(kPlotWidth / map.width, kHighest / map.height);  // of the figure, by px of the image
  plot.width = unit * map.width;
  plot.height = unit * map.height;
  plot.low_x = -0.5;
  plot.high_x = map.width - 0.5;
  plot.top_y = -0.5;
  plot.bottom_y = map.height - 0.5;
  const double cell_width = plot.width / map.columns;
  const double cell_height = plot.height / map.rows;
  std::string svg = begin_svg(plot, name);
  std::string arrows;
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const ResidualMap::Cell& cell = map.cell(column, row);
      const Eigen::Vector2d corner(kLeft + column * cell_width, kTop + row * cell_height);
      const Eigen::Vector2d mean_px = cell.mean_px();
      svg += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\" stroke=\"#ffffff\">",
                         coordinate(corner.x()), coordinate(corner.y()), coordinate(cell_width),
                         coordinate(cell_height), colour_of(cell, scale));
      svg += fmt::format("<title>right {:.3f} px, down {:.3f} px, of {} residuals</title></rect>\n", mean_px.x(),
                         mean_px.y(), cell.count);
      if (cell.count < kLeastResiduals) continue;
      const Eigen::Vector2d middle = corner + 0.5 * Eigen::Vector2d(cell_width, cell_height);
      arrows += arrow(middle, unit * scale.magnification * mean_px) + "\n";
    }
  }
  return svg + "<g class=\"arrows\">\n" + arrows + "</g>\n" + axes(plot, "column, px", "row, px", false) + "</svg>\n";
}

std::string colour_key(std::string_view colour) {
  return fmt::format(
      "<svg class=\"key\" viewBox=\"0 0 20 14\" aria-hidden=\"true\">"
      "<rect x=\"0.5\" y=\"0.5\" width=\"19\" height=\"13\" fill=\"{}\" stroke=\"#8a8a8a\"/></svg>",
      colour);
}

std::string slope_key(SlopeSeries series) {
  const bool before = series == SlopeSeries::kBefore;
  return fmt::format(
      "<svg class=\"key\" viewBox=\"0 0 40 14\" aria-hidden=\"true\"><polyline class=\"{}\" points=\"0,7 40,7\"/>{}"
      "</svg>",
      before ? "before-line" : "after-line", mark(series, 20.0, 7.0));
}

SlopeFigure slope_figure(const ScaleSlope* before, const ScaleSlope* after, std::string_view name) {
  std::vector<const ScaleSlope*> slopes;
  for (const ScaleSlope* slope : {before, after}) {
    if (slope != nullptr) slopes.push_back(slope);
  }
  const Plot plot = slope_plot(slopes);
  SlopeFigure figure;
  figure.svg = begin_svg(plot, name) + axes(plot, "distance driven, m", "scale, % off the ground's", true);
  figure.svg += svg_line(kLeft, plot.y(0.0), kLeft + plot.width, plot.y(0.0), "zero");
  if (before != nullptr) figure.svg += marks(*before, SlopeSeries::kBefore, plot, figure);
  if (after != nullptr) figure.svg += marks(*after, SlopeSeries::kAfter, plot, figure);
  if (before != nullptr) figure.svg += fitted_line(*before, SlopeSeries::kBefore, plot);
  if (after != nullptr) figure.svg += fitted_line(*after, SlopeSeries::kAfter, plot);
  figure.svg += "</svg>\n";
  return figure;
}

}  // namespace groundscale::internal
