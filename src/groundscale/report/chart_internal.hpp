#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace groundscale::internal {

// A figure's own units. The margins leave room for the larger letters of narrow figures.
inline constexpr double kWidth = 760.0;
inline constexpr double kLeft = 104.0;
inline constexpr double kRight = 24.0;
inline constexpr double kTop = 14.0;
inline constexpr double kBottom = 70.0;
inline constexpr double kPlotWidth = kWidth - kLeft - kRight;

/// The plotted part of a figure, and what its axes show.
struct Plot {
  double height = 0.0;  ///< Of the plotted part.
  double width = kPlotWidth;
  double low_x = 0.0, high_x = 1.0;
  double top_y = 1.0, bottom_y = 0.0;

  double x(double value) const { return kLeft + (value - low_x) / (high_x - low_x) * width; }
  double y(double value) const { return kTop + (value - top_y) / (bottom_y - top_y) * height; }
};

std::string svg_line(double x1, double y1, double x2, double y2, std::string_view shape);
std::string svg_text(double x, double y, std::string_view anchor, std::string_view words);
/// @param name  For readers that see no pictures.
std::string begin_svg(const Plot& plot, std::string_view name);
/// Frame, ticks and names of both axes. @param grid  With lines through the plot.
std::string axes(const Plot& plot, std::string_view x_name, std::string_view y_name, bool grid);

/// A place in a chart; y may be NaN, which breaks a line.
struct ChartPoint {
  double x = 0.0;
  double y = 0.0;
};

enum class Drawn {
  kLine,
  kDots,
  kRings,
  kCrosses,
  kSquares,
  kTriangles,
  kDiamonds,
  kPluses,
  kWedges,
  kDashes,
  kUprights
};
inline constexpr int kCurveStyles = 10;
/// The marks that go with a style: other shapes for other styles.
Drawn mark_of(int style);
inline constexpr int kTruthStyle = -1;  ///< Broad and grey, to lie beneath others.

struct ChartCurve {
  std::string name;  ///< In the list of keys; left out there where it is empty.
  Drawn drawn = Drawn::kLine;
  int style = 0;  ///< Colour and dashes, 0 to kCurveStyles - 1, or kTruthStyle.
  std::vector<ChartPoint> points;
};

/// What lies between two lines.
struct ChartBand {
  std::string name;
  struct Range {
    double x = 0.0;
    double low = 0.0;
    double high = 0.0;
  };
  std::vector<Range> ranges;
};

struct Chart {
  std::string name;  ///< For readers that see no pictures.
  std::string x_name, y_name;
  double height = 250.0;
  std::vector<ChartBand> bands;
  std::vector<ChartCurve> curves;  ///< The last is on top.
  std::vector<double> events;      ///< Places of vertical lines.
  std::string event_name{};
  std::optional<double> level{};  ///< A horizontal line.
  bool equal_axes = false;        ///< A metre is as long upwards as to the side.
  bool y_grows_down = false;
};

/// A figure with its keys and, where not everything is drawn, a line that says so; "" where there is nothing to draw.
/// The range of y holds nearly all values: single ones may lie outside, and are counted.
/// @param caption  Text above it.
std::string chart_html(const Chart& chart, std::string_view caption);

/// A bar a row with its name and its value in words; "" where there are none.
struct Bar {
  std::string name;
  double value = 0.0;
  std::string words;
};
std::string bars_html(const std::vector<Bar>& bars, std::string_view name);

/// At most about `most` of the points, in their order: of each piece of the way the first, the lowest and the highest.
std::vector<ChartPoint> thinned(const std::vector<ChartPoint>& points, std::size_t most);

}  // namespace groundscale::internal
