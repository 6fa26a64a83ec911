#pragma once

#include <optional>
#include <string>
#include <vector>

#include "groundscale/core/result.hpp"

namespace groundscale {

/// kBand: filled between the columns `y` and `y_high`. kBars: boxes from the axis up to `y`.
enum class CurveStyle { kLines, kPoints, kLinesPoints, kBand, kBars };

/// One curve: column `y` of the data over column `x`, counted from 0.
struct Curve {
  std::string title;  ///< "": the key says nothing of it.
  int x = 0;
  int y = 1;
  CurveStyle style = CurveStyle::kLines;
  std::optional<int> colour{};  ///< Its number in the palette; as many as curves lie below, where none is said.
  int y_high = 0;               ///< Of a band.
};

/// A figure with its data.
struct Plot {
  std::string name;  ///< Of its files, without ending.
  std::string title;
  std::string x_label, y_label;
  std::vector<std::string> columns;                      ///< Names in the CSV file.
  std::vector<std::vector<std::optional<double>>> rows;  ///< Empty cells are left out of curves.
  std::vector<Curve> curves;                             ///< The last is on top; one without points is left out.
  bool equal_axes = false;                               ///< A metre is as long upwards as to the side.
  std::vector<std::string> settings{};                   ///< Further commands of gnuplot, before the curves are drawn.
};

/// Whether a curve has a point, so that there is something to draw.
bool has_points(const Plot& plot);

/// @pre has_points. The gnuplot script: reads `NAME.csv` and draws `NAME.svg` and `NAME.png`, all in the
/// folder it is run in.
std::string plot_script(const Plot& plot);
/// The data with a heading; numbers in the shortest form that reads back to the same bits.
std::string plot_data(const Plot& plot);

/// Whether the program `gnuplot` can be run.
bool gnuplot_is_there();

/// Writes `NAME.csv` and `NAME.gp` into a folder and, where `draw`, lets gnuplot draw `NAME.svg` and `NAME.png` beside
/// them, unless both are there and come from the same data and script.
/// @return kIo: can't be written; gnuplot fails (it says why on the standard error).
Result<void> write_plot(const std::string& folder, const Plot& plot, bool draw);

}  // namespace groundscale
