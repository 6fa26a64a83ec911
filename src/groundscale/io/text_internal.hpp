#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "groundscale/core/result.hpp"

namespace groundscale::internal {

/// The whole word as a number, locale left aside ("1e-3", "+2", "nan"); nothing where anything is left over.
std::optional<double> parse_number(std::string_view word);
std::optional<long long> parse_integer(std::string_view word);

/// Words of a line, split at blanks; a carriage return counts as one.
std::vector<std::string_view> split_words(std::string_view line);

/// A line of a text with its number, from 1.
struct Line {
  int number = 0;
  std::string_view text;
};

/// Lines of a text without their ends (LF or CRLF); a byte order mark at the start is skipped.
std::vector<Line> split_lines(std::string_view text);

/// Without blanks at both ends.
std::string_view trimmed(std::string_view text);

/// Every byte that isn't printable ASCII as '?', so that a message is fit for any terminal.
std::string printable(std::string_view text);

/// A piece of the user's text for a message: in quotes, cut at 40 characters, printable.
std::string quoted(std::string_view text);

/// Shortest decimal form that reads back to the same bits; at least one digit, never with a locale's comma.
std::string shortest(double value);

/// A CSV field: in quotes where it holds a comma, a quote or a line's end, which becomes a blank.
std::string csv_text(std::string_view text);
/// Fields of a line of comma separated values; "" inside quotes is a quote.
std::vector<std::string> csv_fields(std::string_view line);

Error bad_input(std::string message);

}  // namespace groundscale::internal
