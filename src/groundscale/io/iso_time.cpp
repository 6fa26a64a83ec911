#include <algorithm>
#include <chrono>
#include <string>

#include "groundscale/io/iso_time_internal.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale::internal {
namespace {

/// Takes a text apart from the left.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : text_(text) {}

  /// A number of exactly `digits` digits.
  std::optional<int> digits(std::size_t digits) {
    int number = 0;
    if (text_.size() < digits) return std::nullopt;
    for (const char c : text_.substr(0, digits)) {
      if (c < '0' || c > '9') return std::nullopt;
      number = 10 * number + (c - '0');
    }
    text_.remove_prefix(digits);
    return number;
  }
  bool take(char c) {
    if (text_.empty() || text_.front() != c) return false;
    text_.remove_prefix(1);
    return true;
  }
  /// Digits behind a point or comma, as a part of one; 0 where there are none.
  std::optional<double> fraction() {
    if (!take('.') && !take(',')) return 0.0;
    const std::size_t end = std::min(text_.find_first_not_of("0123456789"), text_.size());
    if (end == 0) return std::nullopt;
    const std::optional<double> value = parse_number("0." + std::string(text_.substr(0, end)));
    text_.remove_prefix(end);
    return value;
  }
  bool at_end() const { return text_.empty(); }

 private:
  std::string_view text_;
};

/// Seconds that the zone is ahead of UTC.
std::optional<double> zone_s(Cursor& cursor) {
  if (cursor.at_end() || cursor.take('Z') || cursor.take('z')) return 0.0;
  const bool ahead = cursor.take('+');
  if (!ahead && !cursor.take('-')) return std::nullopt;
  const auto hours = cursor.digits(2);
  if (!hours || *hours > 23) return std::nullopt;
  std::optional<int> minutes = 0;
  if (cursor.take(':') || !cursor.at_end()) minutes = cursor.digits(2);
  if (!minutes || *minutes > 59) return std::nullopt;
  return (ahead ? 60.0 : -60.0) * (60.0 * *hours + *minutes);
}

}  // namespace

std::optional<double> parse_iso_time(std::string_view text) {
  Cursor cursor(text);
  const auto year = cursor.digits(4);
  if (!year || !cursor.take('-')) return std::nullopt;
  const auto month = cursor.digits(2);
  if (!month || !cursor.take('-')) return std::nullopt;
  const auto day = cursor.digits(2);
  if (!day || !(cursor.take('T') || cursor.take('t') || cursor.take(' '))) return std::nullopt;
  const auto hour = cursor.digits(2);
  if (!hour || *hour > 23 || !cursor.take(':')) return std::nullopt;
  const auto minute = cursor.digits(2);
  if (!minute || *minute > 59 || !cursor.take(':')) return std::nullopt;
  const auto second = cursor.digits(2);
  if (!second || *second > 60) return std::nullopt;
  const auto fraction = cursor.fraction();
  if (!fraction) return std::nullopt;
  const auto zone = zone_s(cursor);
  if (!zone || !cursor.at_end()) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(*year), std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day))};
  if (!date.ok()) return std::nullopt;
  const double days = static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
  return 86400.0 * days + 3600.0 * *hour + 60.0 * *minute + *second + *fraction - *zone;
}

}  // namespace groundscale::internal
