#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/odometry/options.hpp"
#include "groundscale/plane/methods.hpp"

namespace groundscale {

/// Ways to measure the ground by their names, in that order.
/// @param names     As the user gave them; empty: those of `defaults` that there are, or all where that is empty too.
/// @return kBadInput: no such method (those that there are are listed), a name twice.
Result<std::vector<PlaneMethod>> choose_ground_methods(const std::vector<std::string>& names,
                                                       const std::vector<std::string_view>& defaults);

/// The odometry's options with KEY=VALUE of the configuration over `start`. @return kBadInput: unknown key, value out
/// of range.
Result<OdometryOptions> assigned_options(const OdometryOptions& start, const std::vector<std::string>& assignments);

}  // namespace groundscale
