#pragma once

#include <string_view>

namespace groundscale::internal {

/// Prints the broken condition with its place in the source and aborts.
[[noreturn]] void check_failed(std::string_view condition, std::string_view message, std::string_view file, int line,
                               std::string_view function);

}  // namespace groundscale::internal

/// Guards against bugs of the caller (wrong shape, null, index out of range). Never for bad input: that is an Error.
#define GS_CHECK(condition, message)                                                            \
  do {                                                                                          \
    if (!(condition)) [[unlikely]]                                                              \
      ::groundscale::internal::check_failed(#condition, message, __FILE__, __LINE__, __func__); \
  } while (false)
