#include "groundscale/core/check.hpp"

#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>

namespace groundscale::internal {

void check_failed(std::string_view condition, std::string_view message, const std::source_location& where) {
  fmt::print(stderr, "{}:{}: {}: {} (condition: {})\n", where.file_name(), where.line(), where.function_name(), message,
             condition);
  std::abort();
}

}  // namespace groundscale::internal
