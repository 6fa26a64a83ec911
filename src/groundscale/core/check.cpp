#include "groundscale/core/check.hpp"

#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>

namespace groundscale::internal {

void check_failed(std::string_view condition, std::string_view message, std::string_view file, int line,
                  std::string_view function) {
  fmt::print(stderr, "{}:{}: {}: {} (condition: {})\n", file, line, function, message, condition);
  std::abort();
}

}  // namespace groundscale::internal
