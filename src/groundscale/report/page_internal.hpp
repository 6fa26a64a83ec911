#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace groundscale::internal {

/// A whole page: one style for screens of any width and for paper, no scripts, nothing from elsewhere.
/// @param body  Markup below the heading.
std::string page(std::string_view title, const std::string& body);

/// "" without content. @param heading  Markup.
std::string section(std::string_view heading, const std::string& content);

/// "" without text.
std::string paragraph(std::string_view text);

/// What is shown on a click; "" without content. @param summary  Text.
std::string details(std::string_view summary, const std::string& content, bool open = false);

/// Names and values, both text; "" where there are none.
std::string definitions(const std::vector<std::pair<std::string, std::string>>& pairs);

/// What the columns of a table hold behind the first.
enum class Cells {
  kNumbers,
  kWords,    ///< May be broken anywhere.
  kFigures,  ///< A value and the like, and in the last column words.
};
/// A table whose cells are text.
struct TextTable {
  std::vector<std::string> heading;
  std::vector<std::vector<std::string>> rows;
  Cells cells = Cells::kNumbers;
  /// Above the heading: names, each over so many columns; none without.
  std::vector<std::pair<std::string, int>> groups{};
  std::vector<std::string> addresses{};  ///< What the first cells of the rows lead to; none without.
};
/// "" without rows. It scrolls where it is wider than the page.
std::string table_html(const TextTable& table);

/// A list, each item text; "" where there are none.
std::string list_html(const std::vector<std::string>& items);

/// What browsers take for the address of a picture: the file itself. @param type  "image/jpeg".
std::string data_address(std::string_view type, std::string_view bytes);

}  // namespace groundscale::internal
