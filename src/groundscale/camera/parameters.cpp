#include "groundscale/camera/parameters.hpp"

#include <algorithm>
#include <cmath>

#include "groundscale/camera/kannala_brandt.hpp"
#include "groundscale/camera/ocam.hpp"
#include "groundscale/camera/pinhole.hpp"

namespace groundscale {
namespace {

/// Calls `use` with the camera's own type. Every model is named here once.
template <class Use>
auto with_model(const Camera& camera, Use use) {
  if (const auto* fisheye = dynamic_cast<const KannalaBrandtCamera*>(&camera)) return use(*fisheye);
  if (const auto* omnidirectional = dynamic_cast<const OcamCamera*>(&camera)) return use(*omnidirectional);
  const auto* pinhole = dynamic_cast<const PinholeCamera*>(&camera);
  GS_CHECK(pinhole != nullptr, "a camera model that calibration knows");
  return use(*pinhole);
}

/// fx and fy about their mean, as focal_px() has it.
template <class Parameters>
void set_focal(double focal_px, Parameters& parameters) {
  const double stretch = focal_px / (0.5 * (parameters.fx + parameters.fy));
  parameters.fx *= stretch;
  parameters.fy *= stretch;
}

void set_focal(double focal_px, OcamParameters& parameters) {
  const double stretch = focal_px / -parameters.polynomial.front();
  double factor = stretch;  // F(rho) of an image `stretch` times as large
  for (double& coefficient : parameters.polynomial) {
    coefficient *= factor;
    factor /= stretch;
  }
}

template <class Parameters>
double& radial(Parameters& parameters) {
  return parameters.k1;
}

double& radial(OcamParameters& parameters) {
  constexpr std::size_t kSquare = 2;
  if (parameters.polynomial.size() <= kSquare) parameters.polynomial.resize(kSquare + 1, 0.0);
  return parameters.polynomial[kSquare];
}

double half_diagonal_px(const Camera& camera) { return 0.5 * std::hypot(camera.width(), camera.height()); }

}  // namespace

template <>
std::vector<std::string_view> names_of<CameraParameter>() {
  return {"focal", "column", "row", "radial"};
}

std::string_view file_name_of(CameraParameter parameter, const Camera& camera) {
  switch (parameter) {
    case CameraParameter::kFocal:
      return "f";
    case CameraParameter::kColumn:
      return "cx";
    case CameraParameter::kRow:
      return "cy";
    case CameraParameter::kRadial:
      break;
  }
  return camera.model() == "ocam" ? "polynomial[2]" : "k1";
}

std::string_view sd_file_name_of(CameraParameter parameter, std::string_view model) {
  switch (parameter) {
    case CameraParameter::kFocal:
      return "f_sd";
    case CameraParameter::kColumn:
      return "cx_sd";
    case CameraParameter::kRow:
      return "cy_sd";
    case CameraParameter::kRadial:
      break;
  }
  return model == "ocam" ? "polynomial_2_sd" : "k1_sd";
}

double value_of(CameraParameter parameter, const Camera& camera) {
  return with_model(camera, [parameter, &camera](const auto& model) {
    auto parameters = model.parameters();
    switch (parameter) {
      case CameraParameter::kFocal:
        return camera.focal_px();
      case CameraParameter::kColumn:
        return parameters.cx;
      case CameraParameter::kRow:
        return parameters.cy;
      case CameraParameter::kRadial:
        break;
    }
    return radial(parameters);
  });
}

Result<CameraPtr> with_value(CameraParameter parameter, double value, const Camera& camera) {
  return with_model(camera, [parameter, value, &camera](const auto& model) {
    auto parameters = model.parameters();
    switch (parameter) {
      case CameraParameter::kFocal:
        set_focal(value, parameters);
        break;
      case CameraParameter::kColumn:
        parameters.cx = value;
        break;
      case CameraParameter::kRow:
        parameters.cy = value;
        break;
      case CameraParameter::kRadial:
        radial(parameters) = value;
        break;
    }
    return std::decay_t<decltype(model)>::create(parameters, camera.width(), camera.height());
  });
}

double pixel_step(CameraParameter parameter, const Camera& camera) {
  const double radius_px = half_diagonal_px(camera);
  const double focal_px = camera.focal_px();
  switch (parameter) {
    case CameraParameter::kFocal:
      return focal_px / radius_px;
    case CameraParameter::kColumn:
    case CameraParameter::kRow:
      return 1.0;
    case CameraParameter::kRadial:
      break;
  }
  // k1: f r^3 with r = radius / f. OCam: F changes by a2 rho^2, which moves rho by about as much times rho / f.
  if (camera.model() == "ocam") return focal_px / (radius_px * radius_px * radius_px);
  return focal_px * focal_px / (radius_px * radius_px * radius_px);
}

}  // namespace groundscale
