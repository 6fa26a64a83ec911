#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/odometry/options.hpp"
#include "groundscale/plane/methods.hpp"

namespace groundscale {

/// Ways to measure the ground.
/// @param names     As the user gave them, in that order; empty: those of `defaults`, or all where that is empty too,
/// in
///                  the order of `ground_methods`.
/// @return errors of choose_methods.
Result<std::vector<PlaneMethod>> choose_ground_methods(const std::vector<std::string>& names,
                                                       const std::vector<std::string_view>& defaults);

/// The odometry's options with KEY=VALUE of the configuration over `start`. @return kBadInput: unknown key, value out
/// of range.
Result<OdometryOptions> assigned_options(const OdometryOptions& start, const std::vector<std::string>& assignments);

}  // namespace groundscale
