#include "groundscale/io/times_file.hpp"

#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {

using internal::bad_input;
using internal::quoted;

Result<std::vector<double>> read_times(const std::string& path, int expected, std::string_view what) {
  const Result<std::string> text = read_text(path);
  if (!text) return text.error();
  std::vector<double> times_s;
  for (const internal::Line& line : internal::split_lines(*text)) {
    const std::string_view word = internal::trimmed(line.text);
    if (word.empty() || word.front() == '#') continue;
    const std::optional<double> time_s = internal::parse_number(word);
    if (!time_s || !std::isfinite(*time_s)) {
      return bad_input(fmt::format("{}:{}: {} must be one number, a time in seconds", path, line.number, quoted(word)));
    }
    if (!times_s.empty() && *time_s < times_s.back()) {
      return bad_input(fmt::format("{}:{}: time falls from {} to {} s", path, line.number, times_s.back(), *time_s));
    }
    times_s.push_back(*time_s);
  }
  if (static_cast<int>(times_s.size()) != expected) {
    return bad_input(fmt::format("{}: {} rows, but there are {} {}s: it must have a row each", path, times_s.size(),
                                 expected, what));
  }
  if (expected > 1 && !(times_s.back() > times_s.front())) {
    return bad_input(fmt::format("{}: all times are {} s, they must rise", path, times_s.front()));
  }
  return times_s;
}

}  // namespace groundscale
