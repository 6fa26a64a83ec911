#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace groundscale::internal {

/// Text as it may stand in HTML and in a quoted attribute of it. Bytes that are no UTF-8 and control characters but tab
/// and line's end become U+FFFD.
std::string escape_html(std::string_view text);

/// The largest of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten that isn't above a positive value.
double round_down(double value);
/// The smallest of them that isn't below it.
double round_up(double value);

/// A multiple of a round step, with the decimals that the step needs.
std::string step_label(double value, double step);

/// Marks of an axis: all multiples of `step` within its range.
struct Ticks {
  double step = 1.0;  ///< 1, 2 or 5 times a power of ten.
  std::vector<double> values;
  std::string label(double value) const { return step_label(value, step); }
};

/// About `wanted` of them. @param low  Below `high`, both finite.
Ticks ticks_between(double low, double high, int wanted);

/// A coordinate of a figure, to a tenth, the same text for -0 as for 0.
std::string coordinate(double value);

}  // namespace groundscale::internal
