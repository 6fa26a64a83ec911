#pragma once

#include <string>

#include "groundscale/core/result.hpp"

namespace groundscale::internal {

/// As read_text, into a string whose memory is used again: for files read one after the other.
Result<void> read_bytes(const std::string& path, std::string* bytes);

}  // namespace groundscale::internal
