#pragma once

#include <string>
#include <vector>

#include "groundscale/camera/camera.hpp"
#include "groundscale/io/yaml_internal.hpp"

namespace groundscale::internal {

struct ImageSize {
  int width = 0;
  int height = 0;
};

/// A camera model as a camera file holds it.
struct CameraModelFormat {
  const char* name;               ///< Value of `model`.
  std::vector<std::string> keys;  ///< Of the model alone.
  Result<CameraPtr> (*read)(const YamlPlace& file, const ImageSize& size);
  std::string (*write)(const Camera& camera);  ///< The model's keys, a line each.
};

/// All models, in the order of the docs.
const std::vector<CameraModelFormat>& camera_model_formats();

/// Whether a text, comments aside, begins with a number: OCamCalib's `calib_results.txt`, and no YAML mapping.
bool is_ocam_results(const std::string& text);

/// OCamCalib's `calib_results.txt` as the toolbox writes it. `images`: as for read_camera_file.
Result<CameraPtr> parse_ocam_results(const std::string& text, const std::string& path, const ImageSize& images);

}  // namespace groundscale::internal
