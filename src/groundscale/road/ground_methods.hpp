#pragma once

#include <span>
#include <string>
#include <string_view>

#include "groundscale/plane/methods.hpp"

namespace groundscale {

/// Every way to measure the ground: those of plane/, which need no pixels, and those that do.
std::span<const PlaneMethod> ground_methods();

/// The method of that name, null where there is none.
const PlaneMethod* find_ground_method(std::string_view name);

/// Names of all methods, with commas between them.
std::string ground_method_names();

}  // namespace groundscale
