#include "groundscale/experiments/table.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "groundscale/core/check.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {
namespace {

std::string csv_cell(const Cell& cell) {
  if (const auto* text = std::get_if<std::string>(&cell)) return internal::csv_text(*text);
  const auto& value = std::get<std::optional<double>>(cell);
  return value && std::isfinite(*value) ? internal::shortest(*value) : std::string();
}

std::string markdown_cell(const Cell& cell, const Column& column) {
  if (const auto* text = std::get_if<std::string>(&cell)) {
    std::string escaped;
    for (const char c : *text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
    return escaped;
  }
  const auto& value = std::get<std::optional<double>>(cell);
  if (!value || !std::isfinite(*value)) return "";
  return column.sign ? fmt::format("{:+.{}f}", *value, column.decimals)
                     : fmt::format("{:.{}f}", *value, column.decimals);
}

}  // namespace

void Table::add_row(std::vector<Cell> cells) {
  GS_CHECK(cells.size() == columns_.size(), "a row has a cell for every column");
  rows_.push_back(std::move(cells));
}

std::string Table::csv() const {
  std::string csv;
  for (const Column& column : columns_) csv.append(csv.empty() ? "" : ",").append(internal::csv_text(column.name));
  csv += '\n';
  for (const auto& row : rows_) {
    for (std::size_t k = 0; k < row.size(); ++k) csv.append(k == 0 ? "" : ",").append(csv_cell(row[k]));
    csv += '\n';
  }
  return csv;
}

std::vector<Cell> Table::means() const {
  std::vector<Cell> means;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    double sum = 0.0;
    int count = 0;
    for (const auto& row : rows_) {
      const auto* value = std::get_if<std::optional<double>>(&row[k]);
      if (value == nullptr || !*value || !std::isfinite(**value)) continue;
      sum += **value;
      ++count;
    }
    const bool wanted = columns_[k].averaged && !columns_[k].text && count > 0;
    means.emplace_back(wanted ? std::optional(sum / count) : std::nullopt);
  }
  return means;
}

std::string Table::markdown(const std::vector<std::string>& names) const {
  std::vector<std::size_t> chosen;
  for (const std::string& name : names) {
    const auto found = std::find_if(columns_.begin(), columns_.end(), [&](const Column& c) { return c.name == name; });
    GS_CHECK(found != columns_.end(), "the table has columns of these names");
    chosen.push_back(static_cast<std::size_t>(found - columns_.begin()));
  }
  std::string heading = "|";
  std::string rule = "|";
  for (const std::size_t k : chosen) {
    heading += fmt::format(" {} |", columns_[k].title);
    rule += columns_[k].text ? "---|" : "---:|";
  }
  std::string text = heading + "\n" + rule + "\n";
  const auto add_line = [&](const std::vector<Cell>& cells) {
    text += "|";
    for (const std::size_t k : chosen) text += fmt::format(" {} |", markdown_cell(cells[k], columns_[k]));
    text += "\n";
  };
  for (const auto& row : rows_) add_line(row);
  const auto averaged = [this](std::size_t k) { return !columns_[k].text && columns_[k].averaged; };
  if (rows_.size() < 2 || std::none_of(chosen.begin(), chosen.end(), averaged)) return text;
  std::vector<Cell> last = means();
  last[chosen.front()] = std::string("mean");
  add_line(last);
  return text;
}

}  // namespace groundscale
