#include "groundscale/report/chart_internal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/report/markup_internal.hpp"

namespace groundscale::internal {
namespace {

constexpr std::size_t kMostOfALine = 1500;
constexpr std::size_t kMostMarks = 1200;

bool is_finite(const ChartPoint& point) { return std::isfinite(point.x) && std::isfinite(point.y); }

std::string style_class(const ChartCurve& curve) {
  const std::string kind = curve.drawn == Drawn::kLine   ? "curve"
                           : curve.drawn == Drawn::kDots ? "points dot"
                                                         : "points";
  return curve.style == kTruthStyle ? kind + " truth" : fmt::format("{} s{}", kind, curve.style % kCurveStyles);
}

/// A mark as a piece of a path.
std::string mark_path(Drawn drawn, double x, double y) {
  const auto at = [x, y](double dx, double dy) { return coordinate(x + dx) + " " + coordinate(y + dy); };
  switch (drawn) {
    case Drawn::kLine:
      return "";
    case Drawn::kDots:
      return fmt::format("M{}h0", at(0.0, 0.0));
    case Drawn::kRings:
      return fmt::format("M{}a3 3 0 1 0 6 0a3 3 0 1 0 -6 0", at(-3.0, 0.0));
    case Drawn::kCrosses:
      return fmt::format("M{}l6 6m0 -6l-6 6", at(-3.0, -3.0));
    case Drawn::kSquares:
      return fmt::format("M{}h5v5h-5z", at(-2.5, -2.5));
    case Drawn::kTriangles:
      return fmt::format("M{}l3.5 6h-7z", at(0.0, -3.5));
    case Drawn::kDiamonds:
      return fmt::format("M{}l3 4l-3 4l-3 -4z", at(0.0, -4.0));
    case Drawn::kPluses:
      return fmt::format("M{}h7m-3.5 -3.5v7", at(-3.5, 0.0));
    case Drawn::kWedges:
      return fmt::format("M{}h7l-3.5 6z", at(-3.5, -2.5));
    case Drawn::kDashes:
      return fmt::format("M{}h8", at(-4.0, 0.0));
    case Drawn::kUprights:
      return fmt::format("M{}v8", at(0.0, -4.0));
  }
  return "";
}

std::string path_element(const std::string& shape, const std::string& path) {
  return path.empty() ? "" : fmt::format("<path class=\"{}\" d=\"{}\"/>\n", shape, path);
}

/// What was left out of a chart.
struct LeftOut {
  std::size_t outside = 0;
  std::size_t drawn = 0, of = 0;  ///< Marks.
};

std::string line_path(const ChartCurve& curve, const Plot& plot) {
  std::string path;
  bool down = false;
  for (const ChartPoint& point : thinned(curve.points, kMostOfALine)) {
    if (is_finite(point)) {
      path += fmt::format("{}{} {}", down ? "L" : "M", coordinate(plot.x(point.x)), coordinate(plot.y(point.y)));
    }
    down = is_finite(point);
  }
  return path;
}

bool is_inside(const ChartPoint& point, const Plot& plot) {
  const auto [low, high] = std::minmax(plot.bottom_y, plot.top_y);
  return is_finite(point) && point.y >= low && point.y <= high;
}

std::string curve_svg(const ChartCurve& curve, const Plot& plot, LeftOut& left_out) {
  std::vector<ChartPoint> inside;
  for (const ChartPoint& point : curve.points) {
    if (is_inside(point, plot)) inside.push_back(point);
    if (is_finite(point) && !is_inside(point, plot)) ++left_out.outside;
  }
  if (curve.drawn == Drawn::kLine) return path_element(style_class(curve), line_path(curve, plot));
  const std::size_t every = std::max<std::size_t>(1, (inside.size() + kMostMarks - 1) / kMostMarks);
  std::string path;
  for (std::size_t k = 0; k < inside.size(); k += every) {
    path += mark_path(curve.drawn, plot.x(inside[k].x), plot.y(inside[k].y));
    ++left_out.drawn;
  }
  left_out.of += inside.size();
  return path_element(style_class(curve), path);
}

/// Each piece without gaps is a polygon; pieces of many ranges become coarser.
std::string band_svg(const ChartBand& band, const Plot& plot) {
  std::string path;
  std::string back;
  const std::size_t every = std::max<std::size_t>(1, band.ranges.size() / kMostOfALine);
  const auto close = [&path, &back] {
    if (!back.empty()) path += back + "Z";
    back.clear();
  };
  for (std::size_t k = 0; k < band.ranges.size(); k += every) {
    ChartBand::Range range = band.ranges[k];
    for (std::size_t j = k + 1; j < std::min(k + every, band.ranges.size()); ++j) {
      range.low = std::min(range.low, band.ranges[j].low);
      range.high = std::max(range.high, band.ranges[j].high);
    }
    if (!std::isfinite(range.low) || !std::isfinite(range.high)) {
      close();
      continue;
    }
    const std::string x = coordinate(plot.x(range.x));
    path += fmt::format("{}{} {}", back.empty() ? "M" : "L", x, coordinate(plot.y(range.high)));
    back.insert(0, fmt::format("L{} {}", x, coordinate(plot.y(range.low))));
  }
  close();
  return path_element("band", path);
}

/// Lowest and highest of what is drawn but for single values.
struct Span {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void take(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

void take_most(std::vector<double> values, Span& span) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double value) { return !std::isfinite(value); }),
               values.end());
  if (values.empty()) return;
  const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
  const double low = *lowest;
  const double high = *highest;
  constexpr double kShare = 0.01;
  const double low_most = quantile(values, kShare);
  const double high_most = quantile(values, 1.0 - kShare);
  const double margin = 0.35 * (high_most - low_most);
  span.take(std::max(low, low_most - margin));
  span.take(std::min(high, high_most + margin));
}

Span x_span(const Chart& chart) {
  Span span;
  for (const ChartCurve& curve : chart.curves) {
    for (const ChartPoint& point : curve.points) {
      if (is_finite(point)) span.take(point.x);
    }
  }
  for (const ChartBand& band : chart.bands) {
    for (const ChartBand::Range& range : band.ranges) span.take(range.x);
  }
  return span;
}

Span y_span(const Chart& chart) {
  Span span;
  for (const ChartCurve& curve : chart.curves) {
    std::vector<double> values;
    for (const ChartPoint& point : curve.points) values.push_back(point.y);
    if (!chart.equal_axes) take_most(std::move(values), span);
    if (!chart.equal_axes) continue;
    for (const ChartPoint& point : curve.points) span.take(point.y);
  }
  for (const ChartBand& band : chart.bands) {
    std::vector<double> lows, highs;
    for (const ChartBand::Range& range : band.ranges) {
      lows.push_back(range.low);
      highs.push_back(range.high);
    }
    take_most(std::move(lows), span);
    take_most(std::move(highs), span);
  }
  if (chart.level) span.take(*chart.level);
  return span;
}

/// As wide and as high as it may be where a metre is the same in both.
void make_equal(const Span& x, const Span& y, Plot& plot) {
  constexpr double kHighest = 520.0;
  constexpr double kLowest = 140.0;
  const double margin = 0.04 * std::max({x.high - x.low, y.high - y.low, 1e-6});
  const double width_m = x.high - x.low + 2.0 * margin;
  const double height_m = y.high - y.low + 2.0 * margin;
  const double unit = std::min(kPlotWidth / width_m, kHighest / height_m);
  plot.height = std::max(kLowest, unit * height_m);
  const double middle_x = 0.5 * (x.low + x.high);
  const double middle_y = 0.5 * (y.low + y.high);
  plot.low_x = middle_x - 0.5 * plot.width / unit;
  plot.high_x = middle_x + 0.5 * plot.width / unit;
  plot.bottom_y = middle_y - 0.5 * plot.height / unit;
  plot.top_y = middle_y + 0.5 * plot.height / unit;
}

std::optional<Plot> plot_of(const Chart& chart) {
  const Span x = x_span(chart);
  const Span y = y_span(chart);
  if (!(x.low <= x.high) || !(y.low <= y.high)) return std::nullopt;
  Plot plot;
  plot.height = chart.height;
  if (chart.equal_axes) {
    make_equal(x, y, plot);
  } else {
    const double size = std::max({std::abs(y.low), std::abs(y.high), 1e-3});
    const double margin = std::max(0.06 * (y.high - y.low), 1e-3 * size);
    // Ways begin at 0, even where their first value comes a little later.
    plot.low_x = x.low > 0.0 && x.low < 0.1 * x.high ? 0.0 : x.low;
    plot.high_x = x.high;
    if (!(x.high > x.low)) {
      plot.low_x = x.low - 0.5;
      plot.high_x = x.low + 0.5;
    }
    plot.bottom_y = y.low - margin;
    plot.top_y = y.high + margin;
  }
  if (chart.y_grows_down) std::swap(plot.bottom_y, plot.top_y);
  return plot;
}

/// @param width  Of the shape, in its own units.
std::string key_item(const std::string& shape, std::string_view name, double width = 40.0) {
  return fmt::format("<li><svg class=\"key\" viewBox=\"0 0 {} 14\" aria-hidden=\"true\">{}</svg>{}</li>\n", width,
                     shape, escape_html(name));
}

std::string keys_html(const Chart& chart) {
  constexpr double kLine = 80.0;  // shows any dashes more than once
  std::string items;
  for (const ChartCurve& curve : chart.curves) {
    if (curve.name.empty() || curve.points.empty()) continue;
    const bool line = curve.drawn == Drawn::kLine;
    const std::string path =
        line ? fmt::format("M0 7H{}", kLine)
             : mark_path(curve.drawn, 8.0, 7.0) + mark_path(curve.drawn, 20.0, 7.0) + mark_path(curve.drawn, 32.0, 7.0);
    items += key_item(fmt::format("<path class=\"{}\" d=\"{}\"/>", style_class(curve), path), curve.name,
                      line ? kLine : 40.0);
  }
  for (const ChartBand& band : chart.bands) {
    if (!band.ranges.empty()) items += key_item("<path class=\"band\" d=\"M0 1H40V13H0Z\"/>", band.name);
  }
  if (!chart.events.empty() && !chart.event_name.empty()) {
    items += key_item("<path class=\"event\" d=\"M20 0V14\"/>", chart.event_name);
  }
  return items.empty() ? "" : "<ul class=\"keys\">\n" + items + "</ul>\n";
}

std::string remarks_html(const LeftOut& left_out) {
  std::string words;
  if (left_out.drawn < left_out.of) words += fmt::format("{} of {} marks are drawn. ", left_out.drawn, left_out.of);
  if (left_out.outside > 0) {
    words += fmt::format("{} {} outside.", left_out.outside, left_out.outside == 1 ? "value lies" : "values lie");
  }
  return words.empty() ? "" : "<p>" + words + "</p>\n";
}

std::string captioned(std::string_view caption, const std::string& content) {
  const std::string above = caption.empty() ? "" : fmt::format("<figcaption>{}</figcaption>\n", escape_html(caption));
  return "<figure>\n" + above + content + "</figure>\n";
}

}  // namespace

Drawn mark_of(int style) {
  constexpr Drawn kMarks[kCurveStyles] = {Drawn::kRings,     Drawn::kCrosses,  Drawn::kSquares, Drawn::kDots,
                                          Drawn::kTriangles, Drawn::kDiamonds, Drawn::kPluses,  Drawn::kWedges,
                                          Drawn::kDashes,    Drawn::kUprights};
  return kMarks[style % kCurveStyles];
}

std::string svg_line(double x1, double y1, double x2, double y2, std::string_view shape) {
  return fmt::format("<line class=\"{}\" x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"/>\n", shape, coordinate(x1),
                     coordinate(y1), coordinate(x2), coordinate(y2));
}

std::string svg_text(double x, double y, std::string_view anchor, std::string_view words) {
  return fmt::format("<text x=\"{}\" y=\"{}\" dy=\"0.36em\" text-anchor=\"{}\">{}</text>\n", coordinate(x),
                     coordinate(y), anchor, escape_html(words));
}

std::string begin_svg(const Plot& plot, std::string_view name) {
  return fmt::format(
      "<svg class=\"plot\" viewBox=\"0 0 {} {}\" preserveAspectRatio=\"xMinYMid\" role=\"img\" aria-label=\"{}\">\n",
      coordinate(kWidth), coordinate(kTop + plot.height + kBottom), escape_html(name));
}

std::string axes(const Plot& plot, std::string_view x_name, std::string_view y_name, bool grid) {
  std::string svg;
  const double bottom = kTop + plot.height;
  const Ticks x_ticks = ticks_between(plot.low_x, plot.high_x, 6);
  for (const double value : x_ticks.values) {
    const double x = plot.x(value);
    svg += svg_line(x, grid ? kTop : bottom, x, bottom + 6.0, grid ? "grid" : "tick");
    svg += svg_text(x, bottom + 22.0, "middle", x_ticks.label(value));
  }
  const auto [low_y, high_y] = std::minmax(plot.bottom_y, plot.top_y);
  const Ticks y_ticks = ticks_between(low_y, high_y, plot.height < 250.0 ? 3 : 5);
  for (const double value : y_ticks.values) {
    const double y = plot.y(value);
    svg += svg_line(kLeft - 6.0, y, grid ? kLeft + plot.width : kLeft, y, grid ? "grid" : "tick");
    svg += svg_text(kLeft - 10.0, y, "end", y_ticks.label(value));
  }
  svg += fmt::format("<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", coordinate(kLeft),
                     coordinate(kTop), coordinate(plot.width), coordinate(plot.height));
  svg += svg_text(kLeft + 0.5 * plot.width, bottom + 52.0, "middle", x_name);
  // A long name beside a low plot is moved rather than cut off; narrow figures have letters of about 13 units.
  const double half = std::min(6.5 * static_cast<double>(y_name.size()), 0.5 * (bottom + kBottom));
  const double middle = std::clamp(kTop + 0.5 * plot.height, half, bottom + kBottom - half);
  svg += fmt::format("<g transform=\"translate(20 {}) rotate(-90)\">{}</g>\n", coordinate(middle),
                     svg_text(0.0, 0.0, "middle", y_name));
  return svg;
}

std::vector<ChartPoint> thinned(const std::vector<ChartPoint>& points, std::size_t most) {
  if (points.size() <= most) return points;
  const std::size_t pieces = std::max<std::size_t>(1, most / 3);
  std::vector<ChartPoint> kept;
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    const std::size_t begin = piece * points.size() / pieces;
    const std::size_t end = (piece + 1) * points.size() / pieces;
    std::size_t low = begin;
    std::size_t high = begin;
    for (std::size_t k = begin; k < end; ++k) {
      if (points[k].y < points[low].y) low = k;
      if (points[k].y > points[high].y) high = k;
    }
    std::vector<std::size_t> chosen = {begin, std::min(low, high), std::max(low, high)};
    // A gap stays one.
    for (std::size_t k = begin; k < end; ++k) {
      if (!is_finite(points[k])) chosen.push_back(k);
    }
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    for (const std::size_t k : chosen) kept.push_back(points[k]);
  }
  kept.push_back(points.back());
  return kept;
}

std::string chart_html(const Chart& chart, std::string_view caption) {
  const std::optional<Plot> plot = plot_of(chart);
  if (!plot) return "";
  LeftOut left_out;
  // A viewport of its own cuts off what lies outside, without names that would have to differ between figures.
  std::string inside =
      fmt::format("<svg x=\"{0}\" y=\"{1}\" width=\"{2}\" height=\"{3}\" viewBox=\"{0} {1} {2} {3}\">\n",
                  coordinate(kLeft), coordinate(kTop), coordinate(plot->width), coordinate(plot->height));
  for (const ChartBand& band : chart.bands) inside += band_svg(band, *plot);
  if (chart.level) {
    inside += svg_line(kLeft, plot->y(*chart.level), kLeft + plot->width, plot->y(*chart.level), "zero");
  }
  for (const double event : chart.events) {
    inside += svg_line(plot->x(event), kTop, plot->x(event), kTop + plot->height, "event");
  }
  for (const ChartCurve& curve : chart.curves) inside += curve_svg(curve, *plot, left_out);
  const std::string svg =
      begin_svg(*plot, chart.name) + axes(*plot, chart.x_name, chart.y_name, true) + inside + "</svg>\n</svg>\n";
  return captioned(caption, svg + keys_html(chart) + remarks_html(left_out));
}

std::string bars_html(const std::vector<Bar>& bars, std::string_view name) {
  double largest = 0.0;
  for (const Bar& bar : bars) largest = std::max(largest, std::isfinite(bar.value) ? bar.value : 0.0);
  if (!(largest > 0.0)) return "";
  constexpr double kRow = 34.0;
  constexpr double kNames = 300.0;  // room for the names and
  constexpr double kWords = 130.0;  // for the words behind the longest bar
  const double unit = (kWidth - kNames - kWords) / largest;
  std::string svg = fmt::format(
      "<svg class=\"plot\" viewBox=\"0 0 {} {}\" preserveAspectRatio=\"xMinYMid\" role=\"img\" aria-label=\"{}\">\n",
      coordinate(kWidth), coordinate(kRow * static_cast<double>(bars.size())), escape_html(name));
  for (std::size_t k = 0; k < bars.size(); ++k) {
    const double top = kRow * static_cast<double>(k);
    const double length = std::isfinite(bars[k].value) ? std::max(0.0, unit * bars[k].value) : 0.0;
    svg += svg_text(kNames - 10.0, top + 0.5 * kRow, "end", bars[k].name);
    svg += fmt::format("<rect class=\"bar\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", coordinate(kNames),
                       coordinate(top + 6.0), coordinate(length), coordinate(kRow - 12.0));
    svg += svg_text(kNames + length + 8.0, top + 0.5 * kRow, "start", bars[k].words);
  }
  return captioned("", svg + "</svg>\n");
}

}  // namespace groundscale::internal
