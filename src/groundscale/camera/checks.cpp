#include <cmath>

#include <fmt/format.h>

#include "groundscale/camera/checks_internal.hpp"

namespace groundscale::internal {

Result<void> check_image_size(int width, int height) {
  if (width > 0 && height > 0) return {};
  return Error{ErrorCode::kBadInput, fmt::format("image size is {}x{}, both must be above 0", width, height)};
}

Result<void> check_finite(std::initializer_list<NamedValue> values) {
  for (const auto& [name, value] : values) {
    if (std::isfinite(value)) continue;
    return Error{ErrorCode::kBadInput, fmt::format("{} is {}, it must be a finite number", name, value)};
  }
  return {};
}

Result<void> check_focal_lengths(std::initializer_list<NamedValue> values) {
  for (const auto& [name, value] : values) {
    if (value > 0.0) continue;
    return Error{ErrorCode::kBadInput, fmt::format("{} is {}, a focal length must be above 0", name, value)};
  }
  return {};
}

}  // namespace groundscale::internal
