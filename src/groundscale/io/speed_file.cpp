#include "groundscale/io/speed_file.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {
namespace {

using internal::bad_input;
using internal::quoted;

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = line.find(',', begin);
    fields.push_back(internal::trimmed(line.substr(begin, end - begin)));
    if (end == std::string_view::npos) return fields;
    begin = end + 1;
  }
}

/// Where the columns are that are read.
struct Columns {
  std::size_t time = 0;
  std::size_t speed = 0;
  std::size_t count = 0;
};

Result<Columns> columns_of(std::string_view header, const std::string& place) {
  const std::vector<std::string_view> names = fields_of(header);
  const auto find = [&names](std::string_view name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  const Columns columns{find("time_s"), find("speed_mps"), names.size()};
  for (const auto& [column, name] : {std::pair(columns.time, "time_s"), std::pair(columns.speed, "speed_mps")}) {
    if (column < names.size()) {
      if (std::count(names.begin(), names.end(), name) == 1) continue;
      return bad_input(fmt::format("{}: the column {} is there twice", place, name));
    }
    return bad_input(fmt::format(
        "{}: has no column {}; the first line must name the columns, as in 'time_s,speed_mps' (seconds, m/s; "
        "km/h divided by 3.6), and is {}",
        place, name, quoted(header)));
  }
  return columns;
}

Result<double> number_of(std::string_view field, std::string_view column, const std::string& place) {
  const std::optional<double> number = internal::parse_number(field);
  if (number) return *number;
  return bad_input(fmt::format("{}: {}: {} is no number", place, column, quoted(field)));
}

Result<SpeedSample> sample_of(std::string_view line, const Columns& columns, const std::string& place) {
  const std::vector<std::string_view> fields = fields_of(line);
  if (fields.size() != columns.count) {
    return bad_input(
        fmt::format("{}: {} values, but the first line names {} columns", place, fields.size(), columns.count));
  }
  const Result<double> time_s = number_of(fields[columns.time], "time_s", place);
  if (!time_s) return time_s.error();
  const Result<double> speed_mps = number_of(fields[columns.speed], "speed_mps", place);
  if (!speed_mps) return speed_mps.error();
  return SpeedSample{*time_s, *speed_mps};
}

}  // namespace

Result<SpeedLog> read_speed_csv(const std::string& path) {
  const Result<std::string> text = read_text(path);
  if (!text) return text.error();
  std::optional<Columns> columns;
  std::vector<SpeedSample> samples;
  for (const internal::Line& line : internal::split_lines(*text)) {
    const std::string_view content = internal::trimmed(line.text);
    if (content.empty() || content.front() == '#') continue;
    const std::string place = fmt::format("{}:{}", path, line.number);
    if (!columns) {
      const Result<Columns> found = columns_of(content, place);
      if (!found) return found.error();
      columns = *found;
      continue;
    }
    const Result<SpeedSample> sample = sample_of(content, *columns, place);
    if (!sample) return sample.error();
    if (const auto fits = check_sample(samples.empty() ? nullptr : &samples.back(), *sample); !fits) {
      return bad_input(fmt::format("{}: {}", place, fits.error().message));
    }
    samples.push_back(*sample);
  }
  if (!columns) return bad_input(path + ": is empty; the first line must be 'time_s,speed_mps', then a row a speed");
  Result<SpeedLog> log = SpeedLog::create(std::move(samples));
  return log ? std::move(log) : bad_input(fmt::format("{}: {}", path, log.error().message));
}

Result<SpeedLog> read_speed_log(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".gpx" ? read_gpx(path) : read_speed_csv(path);
}

}  // namespace groundscale
