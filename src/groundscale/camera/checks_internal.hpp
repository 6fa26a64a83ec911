#pragma once

#include <initializer_list>
#include <utility>

#include "groundscale/core/result.hpp"

namespace groundscale::internal {

using NamedValue = std::pair<const char*, double>;

/// What every camera model's parameters must hold; kBadInput naming the one that doesn't.
Result<void> check_image_size(int width, int height);
Result<void> check_finite(std::initializer_list<NamedValue> values);
Result<void> check_focal_lengths(std::initializer_list<NamedValue> values);

}  // namespace groundscale::internal
