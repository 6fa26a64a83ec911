#include "groundscale/experiments/truth_rows.hpp"

#include <fmt/format.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {

Result<std::vector<TruthRow>> read_truth_rows(const std::string& path) {
  const auto text = read_text(path);
  if (!text) return text.error();
  std::vector<TruthRow> rows;
  for (const internal::Line& line : internal::split_lines(*text)) {
    if (line.number == 1 || line.text.empty()) continue;
    const std::vector<std::string> cells = internal::csv_fields(line.text);
    const auto number = [&cells](std::size_t column) { return internal::parse_number(cells[column]); };
    constexpr std::size_t kColumns = 7;  // frame, height, plane's height, its normal, speed
    if (cells.size() != kColumns || !number(6)) {
      return internal::bad_input(fmt::format("{}, line {}: seven columns expected", path, line.number));
    }
    TruthRow row{std::nullopt, *number(6)};
    if (number(2) && number(3) && number(4) && number(5)) {
      row.plane = GroundPlane{Eigen::Vector3d(*number(3), *number(4), *number(5)).normalized(), *number(2)};
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace groundscale
