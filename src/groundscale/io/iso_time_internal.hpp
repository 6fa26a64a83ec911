#pragma once

#include <optional>
#include <string_view>

namespace groundscale::internal {

/// Seconds since 1970-01-01 UTC of an ISO 8601 date and time, `2026-05-01T12:34:56.7Z`: with or without a fraction;
/// with `Z`, an offset as `+02:00`, or nothing, which is UTC too. Nothing for anything else. Leap seconds don't count.
std::optional<double> parse_iso_time(std::string_view text);

}  // namespace groundscale::internal
