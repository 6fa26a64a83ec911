#include "groundscale/io/camera_file.hpp"

#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/io/camera_models_internal.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/image_file.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/io/yaml_internal.hpp"

namespace groundscale {
namespace {

using internal::bad_input;
using Size = internal::ImageSize;
using internal::YamlPlace;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// The size that the file states, checked against the images'; else the images'.
Result<Size> read_size(const YamlPlace& file, const Size& images) {
  if (!file.has("image_size")) {
    if (images.width > 0) return images;
    return file.error("image_size is missing: [width, height] in pixels");
  }
  const YamlPlace place = file.child("image_size");
  const Result<std::vector<double>> numbers = internal::numbers_of(place, 2);
  if (!numbers) return numbers.error();
  constexpr double kMaxSide = 65535.0;
  for (const double side : *numbers) {
    if (side < 1.0 || side > kMaxSide || side != std::floor(side)) {
      return place.error(fmt::format("{} must be a whole number from 1 to {}", side, kMaxSide));
    }
  }
  const Size size{static_cast<int>(numbers->at(0)), static_cast<int>(numbers->at(1))};
  if (images.width > 0 && (size.width != images.width || size.height != images.height)) {
    return place.error(fmt::format("{}x{}, but the images are {}x{}: this is the calibration of other images",
                                   size.width, size.height, images.width, images.height));
  }
  return size;
}

Result<const internal::CameraModelFormat*> find_model(const YamlPlace& file) {
  std::string known;
  for (const internal::CameraModelFormat& format : internal::camera_model_formats()) {
    known += (known.empty() ? "" : ", ") + std::string(format.name);
  }
  if (!file.has("model")) return file.error("model is missing, known: " + known);
  const YamlPlace place = file.child("model");
  const std::string model = place.node.IsScalar() ? place.node.Scalar() : "";
  for (const internal::CameraModelFormat& format : internal::camera_model_formats()) {
    if (model == format.name) return &format;
  }
  return place.error(fmt::format("{} is no camera model, known: {}", internal::quoted(model), known));
}

/// An optional number within bounds, both inclusive but for `above`.
struct Bounded {
  const char* key;
  const char* bound;
  double min;
  double max;
};

Result<std::optional<double>> read_bounded(const YamlPlace& file, const Bounded& what) {
  if (!file.has(what.key)) return std::optional<double>();
  const YamlPlace place = file.child(what.key);
  const Result<double> number = internal::number_of(place);
  if (!number) return number.error();
  if (*number < what.min || *number > what.max) {
    return place.error(fmt::format("{} is out of range, it must be {}", *number, what.bound));
  }
  return std::optional<double>(*number);
}

Result<void> read_mounting(const YamlPlace& file, CameraSetup* setup) {
  // A height of a tenth of a millimetre is as good as none; nothing but 0 and below is refused by it.
  const Result<std::optional<double>> height = read_bounded(file, {"height_m", "above 0 m", 1e-4, HUGE_VAL});
  if (!height) return height.error();
  setup->height_m = *height;
  const Result<std::optional<double>> sd = read_bounded(file, {"height_sd_m", "at least 0 m", 0.0, HUGE_VAL});
  if (!sd) return sd.error();
  if (*sd && !*height) return file.child("height_sd_m").error("is there without height_m");
  setup->height_sd_m = *sd;
  const std::pair<Bounded, std::optional<double>*> angles[] = {
      {{"pitch_deg", "from -90 to 90 degrees", -90.0, 90.0}, &setup->pitch_rad},
      {{"roll_deg", "from -90 to 90 degrees", -90.0, 90.0}, &setup->roll_rad},
      {{"yaw_deg", "from -180 to 180 degrees", -180.0, 180.0}, &setup->yaw_rad}};
  for (const auto& [bounded, target] : angles) {
    const Result<std::optional<double>> angle = read_bounded(file, bounded);
    if (!angle) return angle.error();
    if (*angle) *target = **angle * kRadPerDeg;
  }
  return {};
}

constexpr CameraParameter kParameters[] = {CameraParameter::kFocal, CameraParameter::kColumn, CameraParameter::kRow,
                                           CameraParameter::kRadial};

Result<void> read_parameter_sds(const YamlPlace& file, CameraSetup* setup) {
  for (const CameraParameter parameter : kParameters) {
    const std::string key(sd_file_name_of(parameter, setup->camera->model()));
    const auto sd = read_bounded(file, {key.c_str(), "above 0", 1e-300, HUGE_VAL});
    if (!sd) return sd.error();
    if (*sd) setup->parameter_sds[parameter] = **sd;
  }
  return {};
}

Result<Image> mask_of_polygon(const YamlPlace& polygon, const Size& size) {
  if (!polygon.node.IsSequence() || polygon.node.size() < 3) {
    return polygon.error("must be a list of at least 3 corners [x, y] in pixels");
  }
  std::vector<cv::Point> corners;
  for (const YAML::Node& item : polygon.node) {
    const Result<std::vector<double>> corner = internal::numbers_of({item, polygon.source_name, polygon.key}, 2);
    if (!corner) return corner.error();
    constexpr double kFar = 1e6;  // corners may lie outside the image, but cv::fillPoly counts in ints
    if (std::abs(corner->at(0)) > kFar || std::abs(corner->at(1)) > kFar) {
      return polygon.error(fmt::format("corner [{}, {}] is far outside the image", corner->at(0), corner->at(1)));
    }
    corners.emplace_back(static_cast<int>(std::lround(corner->at(0))), static_cast<int>(std::lround(corner->at(1))));
  }
  Image mask(size.width, size.height);
  cv::Mat view(size.height, size.width, CV_8U, mask.data());
  view.setTo(0);
  cv::fillPoly(view, std::vector<std::vector<cv::Point>>{corners}, cv::Scalar(255));
  return mask;
}

Result<Image> mask_of_image(const YamlPlace& place, const Size& size) {
  if (!place.node.IsScalar()) return place.error("must be the name of an image file");
  const std::filesystem::path folder = std::filesystem::path(place.source_name).parent_path();
  const Result<Image> image = read_image((folder / place.node.Scalar()).string());
  if (!image) return place.error(image.error().message);
  if (image->width() != size.width || image->height() != size.height) {
    return place.error(fmt::format("the mask is {}x{}, it must be {}x{} as the camera's images", image->width(),
                                   image->height(), size.width, size.height));
  }
  Image mask(size.width, size.height);
  cv::Mat view(size.height, size.width, CV_8U, mask.data());
  view.setTo(0);
  view.setTo(255, cv::Mat(size.height, size.width, CV_8U, const_cast<std::uint8_t*>(image->data())));
  return mask;
}

Result<Image> read_mask(const YamlPlace& file, const Size& size) {
  if (!file.has("vehicle_mask")) return Image();
  const YamlPlace place = file.child("vehicle_mask");
  if (Result<void> keys = check_keys(place, {"polygon", "image"}); !keys) return keys.error();
  if (place.node.size() != 1) return place.error("must have either polygon or image");
  return place.has("polygon") ? mask_of_polygon(place.child("polygon"), size)
                              : mask_of_image(place.child("image"), size);
}

/// Degrees that become the same radians again; where there are none, the nearest.
double degrees_that_read_back(double rad) {
  const double nearest = rad / kRadPerDeg;
  for (const double degrees : {nearest, std::nextafter(nearest, HUGE_VAL), std::nextafter(nearest, -HUGE_VAL)}) {
    if (degrees * kRadPerDeg == rad) return degrees;
  }
  return nearest;
}

/// Row P<image> as twelve numbers.
struct ProjectionRow {
  std::string place;
  std::vector<double> values;
};

Result<ProjectionRow> find_projection(const std::string& path, int image) {
  const Result<std::string> text = read_text(path);
  if (!text) return text.error();
  constexpr std::size_t kNumbers = 12;
  const std::string name = fmt::format("P{}:", image);
  std::optional<ProjectionRow> found;
  for (const internal::Line& line : internal::split_lines(*text)) {
    const std::vector<std::string_view> words = internal::split_words(line.text);
    if (words.empty() || words.front() != name) continue;
    ProjectionRow row{fmt::format("{}:{}: P{}", path, line.number, image), {}};
    if (found) return bad_input(row.place + ": is there a second time");
    if (words.size() != kNumbers + 1) {
      return bad_input(
          fmt::format("{}: {} values, it must have 12 (a 3x4 matrix, row by row)", row.place, words.size() - 1));
    }
    for (std::size_t k = 1; k <= kNumbers; ++k) {
      const std::optional<double> value = internal::parse_number(words[k]);
      if (!value || !std::isfinite(*value)) {
        return bad_input(
            fmt::format("{}: value {} is {}, it must be a finite number", row.place, k, internal::quoted(words[k])));
      }
      row.values.push_back(*value);
    }
    found = std::move(row);
  }
  if (found) return *found;
  return bad_input(fmt::format("{}: has no row '{}' with 12 numbers", path, name));
}

}  // namespace

Result<CameraSetup> read_camera_file(const std::string& path, int image_width, int image_height) {
  const Result<std::string> text = read_text(path);
  if (!text) return text.error();
  if (internal::is_ocam_results(*text)) {
    Result<CameraPtr> camera = internal::parse_ocam_results(*text, path, {image_width, image_height});
    if (!camera) return camera.error();
    CameraSetup setup;
    setup.camera = *camera;
    return setup;
  }
  const Result<YAML::Node> root = internal::parse_yaml(*text, path);
  if (!root) return root.error();
  const YamlPlace file{*root, path, ""};
  if (!file.node.IsMap()) return bad_input(path + ": must hold keys as in 'model: pinhole'");
  const auto model = find_model(file);
  if (!model) return model.error();
  std::vector<std::string> known = {"model",     "image_size", "height_m", "height_sd_m",
                                    "pitch_deg", "roll_deg",   "yaw_deg",  "vehicle_mask"};
  known.insert(known.end(), (*model)->keys.begin(), (*model)->keys.end());
  for (const CameraParameter parameter : kParameters) known.emplace_back(sd_file_name_of(parameter, (*model)->name));
  if (Result<void> keys = check_keys(file, known); !keys) return keys.error();
  const Result<Size> size = read_size(file, {image_width, image_height});
  if (!size) return size.error();
  const Result<CameraPtr> camera = (*model)->read(file, *size);
  if (!camera) return camera.error();
  CameraSetup setup;
  setup.camera = *camera;
  if (Result<void> mounting = read_mounting(file, &setup); !mounting) return mounting.error();
  if (Result<void> sds = read_parameter_sds(file, &setup); !sds) return sds.error();
  const Result<Image> mask = read_mask(file, *size);
  if (!mask) return mask.error();
  setup.vehicle_mask = *mask;
  return setup;
}

Result<CameraSetup> read_kitti_calibration(const std::string& path, int image, int image_width, int image_height) {
  const Result<ProjectionRow> row = find_projection(path, image);
  if (!row) return row.error();
  const std::vector<double>& p = row->values;
  if (p[1] != 0.0 || p[4] != 0.0 || p[8] != 0.0 || p[9] != 0.0 || p[10] != 1.0) {
    return bad_input(row->place + ": isn't [fx 0 cx . 0 fy cy . 0 0 1 .]");
  }
  const PinholeParameters parameters{.fx = p[0], .fy = p[5], .cx = p[2], .cy = p[6]};
  Result<CameraPtr> camera = PinholeCamera::create(parameters, image_width, image_height);
  if (!camera) return bad_input(fmt::format("{}: {}", row->place, camera.error().message));
  if (!(*camera)->contains({parameters.cx, parameters.cy})) {
    return bad_input(
        fmt::format("{}: the principal point ({}, {}) lies outside the images of {}x{}: this is the calibration of "
                    "other images",
                    row->place, parameters.cx, parameters.cy, image_width, image_height));
  }
  CameraSetup setup;
  setup.camera = *camera;
  return setup;
}

std::string vehicle_mask_path(const std::string& camera_file) {
  const std::filesystem::path file(camera_file);
  return (file.parent_path() / (file.stem().string() + "_vehicle_mask.png")).string();
}

std::string camera_file_text(const CameraSetup& setup, const std::string& mask_name, const std::string& comment) {
  GS_CHECK(setup.camera != nullptr, "a camera");
  const Camera& camera = *setup.camera;
  std::string text;
  for (const internal::Line& line : internal::split_lines(comment)) text += fmt::format("# {}\n", line.text);
  text += fmt::format("model: {}\nimage_size: [{}, {}]\n", camera.model(), camera.width(), camera.height());
  for (const internal::CameraModelFormat& format : internal::camera_model_formats()) {
    if (camera.model() == format.name) text += format.write(camera);
  }
  for (const auto& [parameter, sd] : setup.parameter_sds) {
    text += fmt::format("{}: {}\n", sd_file_name_of(parameter, camera.model()), sd);
  }
  if (setup.height_m) text += fmt::format("height_m: {}\n", *setup.height_m);
  if (setup.height_sd_m) text += fmt::format("height_sd_m: {}\n", *setup.height_sd_m);
  const std::pair<const char*, const std::optional<double>*> angles[] = {
      {"pitch_deg", &setup.pitch_rad}, {"roll_deg", &setup.roll_rad}, {"yaw_deg", &setup.yaw_rad}};
  for (const auto& [key, angle] : angles) {
    if (*angle) text += fmt::format("{}: {}\n", key, degrees_that_read_back(**angle));
  }
  if (!mask_name.empty()) text += fmt::format("vehicle_mask: {{image: \"{}\"}}\n", mask_name);
  return text;
}

Result<void> write_camera_file(const std::string& path, const CameraSetup& setup, const std::string& comment) {
  std::string mask_name;
  if (!setup.vehicle_mask.empty()) {
    const std::string mask = vehicle_mask_path(path);
    if (Result<void> written = write_image(mask, setup.vehicle_mask); !written) return written;
    mask_name = std::filesystem::path(mask).filename().string();
  }
  return write_text(path, camera_file_text(setup, mask_name, comment));
}

}  // namespace groundscale
