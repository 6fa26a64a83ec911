#pragma once

#include <string_view>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/core/result.hpp"

namespace groundscale {

/// What a drive can tell of a camera, the same four numbers of every model.
enum class CameraParameter {
  kFocal,   ///< px, focal_px(). Changing it stretches the whole image about its principal point.
  kColumn,  ///< px, of the principal point (centre of distortion).
  kRow,     ///< px.
  kRadial,  ///< First radial coefficient: k1 of pinhole and Kannala-Brandt; a2 of OCam's polynomial, 1/px.
};

template <>
std::vector<std::string_view> names_of<CameraParameter>();

/// The parameter's name in a camera file: `f`, `cx`, `cy`, `k1`, or `polynomial[2]`.
std::string_view file_name_of(CameraParameter parameter, const Camera& camera);

/// Its standard deviation's: `f_sd`, `cx_sd`, `cy_sd`, `k1_sd`, or `polynomial_2_sd`.
std::string_view sd_file_name_of(CameraParameter parameter, std::string_view model);

double value_of(CameraParameter parameter, const Camera& camera);

/// The camera with another value of one parameter.
/// @return kBadInput where there is no such camera, as its model's `create`.
Result<CameraPtr> with_value(CameraParameter parameter, double value, const Camera& camera);

/// By how much the parameter is changed to move pixels at half of the image's diagonal from the principal point by
/// about 1 px: makes parameters of all kinds and models comparable.
double pixel_step(CameraParameter parameter, const Camera& camera);

}  // namespace groundscale
