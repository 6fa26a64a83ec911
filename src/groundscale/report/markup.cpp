#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "groundscale/report/markup_internal.hpp"

namespace groundscale::internal {
namespace {

constexpr std::string_view kNoCharacter = "\xEF\xBF\xBD";  // U+FFFD
constexpr double kRound[] = {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0};
/// Products of round numbers miss each other by less.
constexpr double kRounding = 1e-9;

unsigned byte_at(std::string_view text, std::size_t k) { return static_cast<unsigned char>(text[k]); }

/// Bytes of the character that begins at k (Unicode 15, table 3-7); 0 where none does.
std::size_t utf8_length(std::string_view text, std::size_t k) {
  const unsigned lead = byte_at(text, k);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || k + length > text.size()) return 0;
  for (std::size_t j = 1; j < length; ++j) {
    if ((byte_at(text, k + j) & 0xC0) != 0x80) return 0;
  }
  const unsigned second = byte_at(text, k + 1);
  const bool too_long = (lead == 0xE0 && second < 0xA0) || (lead == 0xF0 && second < 0x90);
  const bool surrogate = lead == 0xED && second > 0x9F;
  const bool too_high = lead == 0xF4 && second > 0x8F;
  return too_long || surrogate || too_high ? 0 : length;
}

double power_of_ten_below(double value) { return std::pow(10.0, std::floor(std::log10(value))); }

}  // namespace

std::string escape_html(std::string_view text) {
  std::string escaped;
  for (std::size_t k = 0; k < text.size();) {
    const std::size_t length = utf8_length(text, k);
    const char c = text[k];
    if (length > 1) {
      escaped += text.substr(k, length);
    } else if (length == 0 || (byte_at(text, k) < 0x20 && c != '\n' && c != '\t') || byte_at(text, k) == 0x7F) {
      escaped += kNoCharacter;
    } else if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '>') {
      escaped += "&gt;";
    } else if (c == '"') {
      escaped += "&quot;";
    } else if (c == '\'') {
      escaped += "&#39;";
    } else {
      escaped += c;
    }
    k += std::max<std::size_t>(1, length);
  }
  return escaped;
}

double round_down(double value) {
  const double power = power_of_ten_below(value);
  const auto above = std::upper_bound(std::begin(kRound), std::end(kRound), value / power * (1.0 + kRounding));
  return power * *std::prev(above);
}

double round_up(double value) {
  const double power = power_of_ten_below(value);
  return power * *std::lower_bound(std::begin(kRound), std::prev(std::end(kRound)), value / power * (1.0 - kRounding));
}

std::string step_label(double value, double step) {
  const double leading = step / power_of_ten_below(step * (1.0 + kRounding));
  const int more = std::abs(leading - std::round(leading)) > kRounding ? 1 : 0;
  const int decimals = std::max(0, more - static_cast<int>(std::floor(std::log10(step) + kRounding)));
  // Adding 0 turns -0 into 0.
  return fmt::format("{:.{}f}", std::round(value / step) * step + 0.0, decimals);
}

Ticks ticks_between(double low, double high, int wanted) {
  const double rough = (high - low) / wanted;
  const double power = power_of_ten_below(rough);
  Ticks ticks;
  // The nearest by ratio: borders are the roots of 1 * 2, 2 * 5 and 5 * 10.
  const double leading = rough / power;
  ticks.step = power * (leading < 1.414 ? 1.0 : leading < 3.162 ? 2.0 : leading < 7.071 ? 5.0 : 10.0);
  const double first = std::ceil(low / ticks.step - kRounding);
  for (double k = first; k * ticks.step <= high + kRounding * ticks.step; k += 1.0) {
    ticks.values.push_back(k * ticks.step);
  }
  return ticks;
}

std::string coordinate(double value) { return fmt::format("{:.1f}", std::round(value * 10.0) / 10.0 + 0.0); }

}  // namespace groundscale::internal
