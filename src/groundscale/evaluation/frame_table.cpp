#include "groundscale/evaluation/frame_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {
namespace {

using internal::bad_input;

enum Column {
  kFrame,
  kTime,
  kStepSd,
  kOnlineStep,
  kRawStep,
  kRawStepSd,
  kReason,
  kOnlineStepSd,
  kState,
  kStep,
  kPitch,
  kRoll,
  kRoadMatches,
  kRoadInliers,
  kMapScale,
  kDriftRatio,
  kColumns
};
/// Those from here on may be missing.
constexpr std::size_t kNeeded = kOnlineStepSd;
constexpr std::array<std::string_view, kColumns> kNames{
    "frame", "time_s", "step_sd_m", "online_step_m", "raw_step_m",   "raw_step_sd_m", "reason",    "online_step_sd_m",
    "state", "step_m", "pitch_deg", "roll_deg",      "road_matches", "road_inliers",  "map_scale", "drift_ratio"};
constexpr double kLowest = std::numeric_limits<double>::lowest();

struct Header {
  std::size_t width = 0;
  std::array<std::optional<std::size_t>, kColumns> index;
};

Result<Header> parse_header(std::string_view line, const std::string& path) {
  const std::vector<std::string> names = internal::csv_fields(line);
  Header header;
  header.width = names.size();
  for (std::size_t column = 0; column < kColumns; ++column) {
    const auto found = std::find(names.begin(), names.end(), kNames[column]);
    if (found != names.end()) {
      header.index[column] = static_cast<std::size_t>(found - names.begin());
    } else if (column < kNeeded) {
      return bad_input(fmt::format("{}:1: no column '{}'", path, kNames[column]));
    }
  }
  return header;
}

/// One row of the table, and the first thing that is wrong with it.
class RowParser {
 public:
  RowParser(const std::vector<std::string>& fields, const Header& header, std::string place)
      : fields_(fields), header_(header), place_(std::move(place)) {}

  std::optional<double> number(Column column, double min) {
    const std::string text = field(column);
    if (text.empty()) return std::nullopt;
    const std::optional<double> value = internal::parse_number(text);
    if (value && std::isfinite(*value) && *value >= min) return value;
    fail(column, min == 0.0 ? "a number from 0 on, or empty" : "a finite number, or empty");
    return std::nullopt;
  }

  int frame_number() {
    const std::optional<long long> value = internal::parse_integer(field(kFrame));
    if (value && *value >= 0 && *value <= std::numeric_limits<int>::max()) return static_cast<int>(*value);
    fail(kFrame, "a frame number from 0 on");
    return 0;
  }

  /// Empty where there is no such column.
  std::string field(Column column) const {
    const auto& index = header_.index[column];
    return index ? fields_[*index] : std::string();
  }
  const Result<void>& result() const { return result_; }

 private:
  void fail(Column column, std::string_view right) {
    if (!result_) return;
    result_ = bad_input(
        fmt::format("{}: {} is {}, it must be {}", place_, kNames[column], internal::quoted(field(column)), right));
  }

  const std::vector<std::string>& fields_;
  const Header& header_;
  std::string place_;
  Result<void> result_;
};

Result<FrameRow> parse_row(const internal::Line& line, const Header& header, const std::string& path) {
  const std::vector<std::string> fields = internal::csv_fields(line.text);
  std::string place = fmt::format("{}:{}", path, line.number);
  if (fields.size() != header.width) {
    return bad_input(fmt::format("{}: {} fields, the header has {}", place, fields.size(), header.width));
  }
  RowParser parser(fields, header, std::move(place));
  FrameRow row;
  row.frame = parser.frame_number();
  row.time_s = parser.number(kTime, kLowest);
  row.step_sd_m = parser.number(kStepSd, 0.0);
  row.online_step_m = parser.number(kOnlineStep, 0.0);
  row.online_step_sd_m = parser.number(kOnlineStepSd, 0.0);
  row.raw_step_m = parser.number(kRawStep, 0.0);
  row.raw_step_sd_m = parser.number(kRawStepSd, 0.0);
  row.reason = parser.field(kReason);
  row.state = parser.field(kState);
  row.step_m = parser.number(kStep, 0.0);
  row.pitch_deg = parser.number(kPitch, kLowest);
  row.roll_deg = parser.number(kRoll, kLowest);
  row.road_matches = parser.number(kRoadMatches, 0.0);
  row.road_inliers = parser.number(kRoadInliers, 0.0);
  row.map_scale = parser.number(kMapScale, 0.0);
  row.drift_ratio = parser.number(kDriftRatio, 0.0);
  if (!parser.result()) return parser.result().error();
  return row;
}

Result<void> check_order(const FrameRow& before, const FrameRow& row, const std::string& place) {
  if (row.frame <= before.frame) {
    return bad_input(fmt::format("{}: frame {} after frame {}, numbers must rise", place, row.frame, before.frame));
  }
  if (row.time_s.has_value() != before.time_s.has_value()) {
    return bad_input(fmt::format("{}: time_s must be there for all rows or for none", place));
  }
  if (row.time_s && *row.time_s < *before.time_s) {
    return bad_input(fmt::format("{}: time falls from {} to {} s", place, *before.time_s, *row.time_s));
  }
  return {};
}

}  // namespace

Result<std::vector<FrameRow>> read_frame_table(const std::string& path) {
  const Result<std::string> text = read_text(path);
  if (!text) return text.error();
  const std::vector<internal::Line> lines = internal::split_lines(*text);
  if (lines.empty()) return bad_input(path + ": empty, a header and a row a frame are expected");
  const Result<Header> header = parse_header(lines.front().text, path);
  if (!header) return header.error();
  std::vector<FrameRow> rows;
  for (std::size_t k = 1; k < lines.size(); ++k) {
    if (internal::trimmed(lines[k].text).empty()) continue;
    const Result<FrameRow> row = parse_row(lines[k], *header, path);
    if (!row) return row.error();
    if (!rows.empty()) {
      const Result<void> order = check_order(rows.back(), *row, fmt::format("{}:{}", path, lines[k].number));
      if (!order) return order.error();
    }
    rows.push_back(*row);
  }
  return rows;
}

}  // namespace groundscale
