#include "groundscale/experiments/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "groundscale/core/check.hpp"
#include "groundscale/experiments/child_process.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;

/// Told apart by the colour-blind too (Okabe and Ito, then Tol), dark enough for paper.
constexpr std::array<std::string_view, 11> kColours = {"#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00",
                                                       "#56b4e9", "#882255", "#999933", "#332288", "#888888"};

/// A text in gnuplot's single quotes.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "'";
}

std::string style_of(CurveStyle style, std::size_t curve) {
  const std::string_view colour = kColours[curve % kColours.size()];
  switch (style) {
    case CurveStyle::kLines:
      return fmt::format("with lines linewidth 1.5 linecolor rgb '{}'", colour);
    case CurveStyle::kPoints:
      return fmt::format("with points pointtype 7 pointsize 0.4 linecolor rgb '{}'", colour);
    case CurveStyle::kBand:
      return fmt::format("with filledcurves fillstyle transparent solid 0.15 noborder linecolor rgb '{}'", colour);
    case CurveStyle::kBars:
      return fmt::format("with boxes linecolor rgb '{}' fillstyle solid 0.7 noborder", colour);
    case CurveStyle::kLinesPoints:
      break;
  }
  return fmt::format("with linespoints pointtype {} pointsize 0.8 linewidth 1.5 linecolor rgb '{}'", curve + 4, colour);
}

/// A row's point of a curve; nothing where one of its cells is empty.
bool point_of(const std::vector<std::optional<double>>& row, const Curve& curve, double& x, double& y) {
  const auto& x_cell = row[static_cast<std::size_t>(curve.x)];
  const auto& y_cell = row[static_cast<std::size_t>(curve.y)];
  if (!x_cell || !y_cell || !std::isfinite(*x_cell) || !std::isfinite(*y_cell)) return false;
  x = *x_cell;
  y = *y_cell;
  return true;
}

bool has_points(const Plot& plot, const Curve& curve) {
  double x = 0.0, y = 0.0;
  return std::any_of(plot.rows.begin(), plot.rows.end(), [&](const auto& row) { return point_of(row, curve, x, y); });
}

/// The columns that a curve is drawn from, as gnuplot counts them.
std::string columns_of(const Curve& curve) {
  const std::string columns = fmt::format("{}:{}", curve.x + 1, curve.y + 1);
  return curve.style == CurveStyle::kBand ? fmt::format("{}:{}", columns, curve.y_high + 1) : columns;
}

/// Ranges that hold all points and have the picture's proportions, so that equal axes leave no side narrow.
std::string equal_ranges(const Plot& plot) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double min_x = kInfinity, max_x = -kInfinity, min_y = kInfinity, max_y = -kInfinity;
  for (const Curve& curve : plot.curves) {
    for (const auto& row : plot.rows) {
      double x = 0.0, y = 0.0;
      if (!point_of(row, curve, x, y)) continue;
      min_x = std::min(min_x, x);
      max_x = std::max(max_x, x);
      min_y = std::min(min_y, y);
      max_y = std::max(max_y, y);
    }
  }
  if (min_x > max_x) return "";
  constexpr double kMargin = 1.08;
  constexpr double kMinHeight = 1e-3;
  constexpr double kProportions = 1.7;
  const double height = kMargin * std::max({max_y - min_y, (max_x - min_x) / kProportions, kMinHeight});
  const double x = 0.5 * (min_x + max_x), y = 0.5 * (min_y + max_y);
  return fmt::format("set size ratio -1\nset xrange [{:.6g}:{:.6g}]\nset yrange [{:.6g}:{:.6g}]\n",
                     x - 0.5 * kProportions * height, x + 0.5 * kProportions * height, y - 0.5 * height,
                     y + 0.5 * height);
}

std::string draw_command(const Plot& plot) {
  std::string text = "plot ";
  for (std::size_t k = 0; k < plot.curves.size(); ++k) {
    const Curve& curve = plot.curves[k];
    if (!has_points(plot, curve)) continue;  // keeps its colour elsewhere
    text += fmt::format("{}{} skip 1 using {} {} {}", text == "plot " ? "" : ", \\\n     ", quoted(plot.name + ".csv"),
                        columns_of(curve),
                        style_of(curve.style, static_cast<std::size_t>(curve.colour.value_or(static_cast<int>(k)))),
                        curve.title.empty() ? std::string("notitle") : "title " + quoted(curve.title));
  }
  return text + "\n";
}

/// Lines that the key needs below the axis: gnuplot gives each title the room of the longest.
std::size_t key_lines(const Plot& plot) {
  constexpr std::size_t kLetters = 80;  // a line of the SVG file holds, the narrower of both
  constexpr std::size_t kSample = 6;    // letters' room of a curve's sample
  std::size_t titles = 0;
  std::size_t longest = 0;
  for (const Curve& curve : plot.curves) {
    if (curve.title.empty() || !has_points(plot, curve)) continue;
    ++titles;
    longest = std::max(longest, curve.title.size());
  }
  const std::size_t in_a_line = std::max<std::size_t>(1, kLetters / (longest + kSample));
  return std::max<std::size_t>(1, (titles + in_a_line - 1) / in_a_line);
}

/// Whether a file holds exactly this.
bool holds(const fs::path& path, const std::string& text) {
  const auto present = read_text(path.string());
  return present && *present == text;
}

}  // namespace

bool has_points(const Plot& plot) {
  return std::any_of(plot.curves.begin(), plot.curves.end(),
                     [&plot](const Curve& curve) { return has_points(plot, curve); });
}

std::string plot_script(const Plot& plot) {
  GS_CHECK(has_points(plot), "a figure has a curve with points");
  std::string text =
      fmt::format("# gnuplot {0}.gp, in this folder, draws {0}.svg and {0}.png from {0}.csv.\n", plot.name);
  text += "set datafile separator ','\nset encoding utf8\n";
  text += fmt::format("set title {}\nset xlabel {}\nset ylabel {}\n", quoted(plot.title), quoted(plot.x_label),
                      quoted(plot.y_label));
  text += fmt::format(
      "set grid linetype 1 linecolor rgb '#dddddd'\nset key outside bottom center horizontal\nset bmargin {}\n",
      4 + key_lines(plot));
  if (plot.equal_axes) text += equal_ranges(plot);
  for (const std::string& setting : plot.settings) text += setting + "\n";
  text += fmt::format(
      "set terminal svg noenhanced size 900,560 font 'DejaVu Sans,13' background rgb 'white'\n"
      "set output '{0}.svg'\n{1}"
      "set terminal pngcairo noenhanced size 1350,840 font 'DejaVu Sans,13' fontscale 1.1\n"
      "set output '{0}.png'\nreplot\nset output\n",
      plot.name, draw_command(plot));
  return text;
}

std::string plot_data(const Plot& plot) {
  std::string text;
  for (const std::string& column : plot.columns)
    text.append(text.empty() ? "" : ",").append(internal::csv_text(column));
  text += '\n';
  for (const auto& row : plot.rows) {
    GS_CHECK(row.size() == plot.columns.size(), "a row has a cell for every column");
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (k > 0) text += ',';
      if (row[k] && std::isfinite(*row[k])) text += internal::shortest(*row[k]);
    }
    text += '\n';
  }
  return text;
}

bool gnuplot_is_there() {
  const auto run = run_child({.program = "gnuplot", .arguments = {"--version"}});
  return run && run->status == 0;
}

Result<void> write_plot(const std::string& folder, const Plot& plot, bool draw) {
  const fs::path base = fs::path(folder) / plot.name;
  const auto file = [&base](const char* ending) { return fs::path(base).concat(ending); };
  const std::string data = plot_data(plot);
  const std::string script = plot_script(plot);
  const bool same = holds(file(".csv"), data) && holds(file(".gp"), script);
  std::error_code ignored;
  if (same && (!draw || (fs::exists(file(".svg"), ignored) && fs::exists(file(".png"), ignored)))) return {};

  // The script gets its name last: where it has it, the pictures are whole.
  for (const char* ending : {".gp", ".svg", ".png"}) fs::remove(file(ending), ignored);
  if (const auto written = write_text(file(".csv").string(), data); !written) return written;
  const std::string beside = plot.name + ".gp.part";
  if (const auto written = write_text((fs::path(folder) / beside).string(), script); !written) return written;
  Result<void> drawn;
  if (draw) {
    const auto run = run_child({.program = "gnuplot", .arguments = {beside}, .folder = folder});
    if (!run) drawn = run.error();
    if (run && run->status != 0) {
      drawn = Error{ErrorCode::kIo, fmt::format("{}: gnuplot ended with status {}", file(".gp").string(), run->status)};
    }
    if (!drawn) {
      for (const char* ending : {".svg", ".png"}) fs::remove(file(ending), ignored);
    }
  }
  std::error_code error;
  fs::rename(fs::path(folder) / beside, file(".gp"), error);
  if (error)
    return Error{ErrorCode::kIo, fmt::format("{}: can't be written: {}", file(".gp").string(), error.message())};
  return drawn;
}

}  // namespace groundscale
