#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "groundscale/core/result.hpp"

namespace groundscale {

/// Rows of a times.txt, one number in seconds each. @return kBadInput with file and line for anything else, for times
/// that fall, and for a number of rows that isn't `expected`.
/// @param what  What a row belongs to, for the message: "image", "pose".
Result<std::vector<double>> read_times(const std::string& path, int expected, std::string_view what);

}  // namespace groundscale
