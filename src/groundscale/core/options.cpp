#include "groundscale/core/options.hpp"

#include <cmath>

#include <fmt/format.h>

namespace groundscale {

std::string range_text(const FieldInfo& info) {
  const std::string unit = info.unit.empty() ? "" : fmt::format(" {}", info.unit);
  if (std::isfinite(info.min) && std::isfinite(info.max))
    return fmt::format("from {} to {}{}", info.min, info.max, unit);
  if (std::isfinite(info.min)) return fmt::format("at least {}{}", info.min, unit);
  if (std::isfinite(info.max)) return fmt::format("at most {}{}", info.max, unit);
  return "";
}

void NamedFieldVisitor::enter(std::string_view key) { prefix_ += std::string(key) + "."; }

void NamedFieldVisitor::leave() {
  prefix_.pop_back();
  const std::size_t dot = prefix_.rfind('.');
  prefix_.resize(dot == std::string::npos ? 0 : dot + 1);
}

namespace internal {

void RangeCheck::field(const FieldInfo&, bool&) {}
void RangeCheck::field(const FieldInfo& info, int& value) { check(info, value); }
void RangeCheck::field(const FieldInfo& info, double& value) { check(info, value); }
void RangeCheck::field(const FieldInfo&, std::string&) {}
void RangeCheck::field(const FieldInfo& info, std::vector<double>& value) {
  for (const double v : value) check(info, v);
}
void RangeCheck::field(const FieldInfo&, Choice) {}

void RangeCheck::check(const FieldInfo& info, double value) {
  if (!result_ || (std::isfinite(value) && value >= info.min && value <= info.max)) return;
  const std::string range = range_text(info);
  result_ = Error{ErrorCode::kBadInput, fmt::format("{}: {} is out of range, it must be {}", name_of(info), value,
                                                    range.empty() ? "a finite number" : range)};
}

}  // namespace internal
}  // namespace groundscale
