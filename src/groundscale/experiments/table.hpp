#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace groundscale {

/// A column of a table: its name in CSV, and how Markdown shows it.
struct Column {
  std::string name;
  std::string title;     ///< Markdown's heading, unit included.
  int decimals = 2;      ///< Of Markdown; CSV has full precision.
  bool sign = false;     ///< Always shown.
  bool text = false;     ///< Holds words.
  bool averaged = true;  ///< Has a value in the row of means.
};

/// Words or a number; empty where there is nothing to measure.
using Cell = std::variant<std::optional<double>, std::string>;

/// One table from which both a CSV file and Markdown are made.
class Table {
 public:
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// @pre a cell for every column.
  void add_row(std::vector<Cell> cells);
  const std::vector<Column>& columns() const { return columns_; }
  const std::vector<std::vector<Cell>>& rows() const { return rows_; }

  /// A heading and a line a row; numbers in the shortest form that reads back to the same bits.
  std::string csv() const;
  /// Some columns, in the order of their names here; below the rows, where there are several, their means over the
  /// cells that have a value. @pre columns of these names.
  std::string markdown(const std::vector<std::string>& names) const;

 private:
  std::vector<Cell> means() const;

  std::vector<Column> columns_;
  std::vector<std::vector<Cell>> rows_;
};

}  // namespace groundscale
