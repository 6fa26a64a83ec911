// What each camera model's part of a camera file looks like.
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "groundscale/camera/kannala_brandt.hpp"
#include "groundscale/camera/ocam.hpp"
#include "groundscale/camera/pinhole.hpp"
#include "groundscale/io/camera_models_internal.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale::internal {
namespace {

using NamedTarget = std::pair<const char*, double*>;

Result<void> read_number(const YamlPlace& map, const NamedTarget& target, bool required) {
  if (!map.has(target.first)) {
    if (!required) return {};
    return map.error(fmt::format("{} is missing: a number is needed", target.first));
  }
  const Result<double> number = number_of(map.child(target.first));
  if (!number) return number.error();
  *target.second = *number;
  return {};
}

Result<void> read_required(const YamlPlace& map, const std::vector<NamedTarget>& targets) {
  for (const NamedTarget& target : targets) {
    if (Result<void> read = read_number(map, target, true); !read) return read;
  }
  return {};
}

/// An optional mapping whose numbers are what they were where they are left out.
Result<void> read_optional_map(const YamlPlace& file, const char* key, const std::vector<NamedTarget>& targets) {
  if (!file.has(key)) return {};
  const YamlPlace map = file.child(key);
  std::vector<std::string> names;
  for (const NamedTarget& target : targets) names.emplace_back(target.first);
  if (Result<void> keys = check_keys(map, names); !keys) return keys;
  for (const NamedTarget& target : targets) {
    if (Result<void> read = read_number(map, target, false); !read) return read;
  }
  return {};
}

/// Focal lengths and principal point.
template <class Parameters>
Result<void> read_matrix(const YamlPlace& file, Parameters& p) {
  if (Result<void> read = read_required(file, {{"fx", &p.fx}, {"fy", &p.fy}, {"cx", &p.cx}, {"cy", &p.cy}}); !read) {
    return read;
  }
  for (const NamedTarget& target : {NamedTarget{"fx", &p.fx}, {"fy", &p.fy}}) {
    if (*target.second > 0.0) continue;
    return file.child(target.first).error(fmt::format("{}, a focal length must be above 0", *target.second));
  }
  return {};
}

Result<CameraPtr> placed(Result<CameraPtr> camera, const YamlPlace& file) {
  if (!camera) return file.error(camera.error().message);
  return camera;
}

template <class Parameters>
std::string matrix_text(const Parameters& p) {
  return fmt::format("fx: {}\nfy: {}\ncx: {}\ncy: {}\n", p.fx, p.fy, p.cx, p.cy);
}

Result<CameraPtr> read_pinhole(const YamlPlace& file, const ImageSize& size) {
  PinholeParameters p;
  if (Result<void> read = read_matrix(file, p); !read) return read.error();
  const Result<void> read = read_optional_map(
      file, "distortion", {{"k1", &p.k1}, {"k2", &p.k2}, {"p1", &p.p1}, {"p2", &p.p2}, {"k3", &p.k3}});
  if (!read) return read.error();
  return placed(PinholeCamera::create(p, size.width, size.height), file);
}

std::string write_pinhole(const Camera& camera) {
  const PinholeParameters& p = dynamic_cast<const PinholeCamera&>(camera).parameters();
  return matrix_text(p) +
         fmt::format("distortion: {{k1: {}, k2: {}, p1: {}, p2: {}, k3: {}}}\n", p.k1, p.k2, p.p1, p.p2, p.k3);
}

Result<CameraPtr> read_kannala_brandt(const YamlPlace& file, const ImageSize& size) {
  KannalaBrandtParameters p;
  if (Result<void> read = read_matrix(file, p); !read) return read.error();
  const Result<void> read =
      read_optional_map(file, "distortion", {{"k1", &p.k1}, {"k2", &p.k2}, {"k3", &p.k3}, {"k4", &p.k4}});
  if (!read) return read.error();
  return placed(KannalaBrandtCamera::create(p, size.width, size.height), file);
}

std::string write_kannala_brandt(const Camera& camera) {
  const KannalaBrandtParameters& p = dynamic_cast<const KannalaBrandtCamera&>(camera).parameters();
  return matrix_text(p) + fmt::format("distortion: {{k1: {}, k2: {}, k3: {}, k4: {}}}\n", p.k1, p.k2, p.k3, p.k4);
}

Result<CameraPtr> read_ocam(const YamlPlace& file, const ImageSize& size) {
  OcamParameters p;
  if (Result<void> read = read_required(file, {{"cx", &p.cx}, {"cy", &p.cy}}); !read) return read.error();
  if (Result<void> read = read_optional_map(file, "affine", {{"c", &p.c}, {"d", &p.d}, {"e", &p.e}}); !read) {
    return read.error();
  }
  if (!file.has("polynomial")) return file.error("polynomial is missing: a list of numbers is needed");
  const YamlPlace list = file.child("polynomial");
  constexpr std::size_t kMaxCoefficients = 20;
  if (!list.node.IsSequence() || list.node.size() < 1 || list.node.size() > kMaxCoefficients) {
    return list.error(fmt::format("must be a list of 1 to {} numbers", kMaxCoefficients));
  }
  const Result<std::vector<double>> polynomial = numbers_of(list, static_cast<int>(list.node.size()));
  if (!polynomial) return polynomial.error();
  p.polynomial = *polynomial;
  return placed(OcamCamera::create(p, size.width, size.height), file);
}

std::string write_ocam(const Camera& camera) {
  const OcamParameters& p = dynamic_cast<const OcamCamera&>(camera).parameters();
  return fmt::format("polynomial: [{}]\ncx: {}\ncy: {}\naffine: {{c: {}, d: {}, e: {}}}\n",
                     fmt::join(p.polynomial, ", "), p.cx, p.cy, p.c, p.d, p.e);
}

/// Numbers of a toolbox file in their order, comments left out, with the place of each for messages.
class OcamNumbers {
 public:
  static Result<OcamNumbers> of(const std::string& text, const std::string& path) {
    OcamNumbers numbers(path);
    for (const Line& line : split_lines(text)) {
      if (trimmed(line.text).starts_with('#')) continue;
      for (const std::string_view word : split_words(line.text)) {
        const std::optional<double> value = parse_number(word);
        if (!value || !std::isfinite(*value)) {
          return bad_input(fmt::format("{}:{}: {} isn't a finite number", path, line.number, quoted(word)));
        }
        numbers.values_.push_back(*value);
      }
    }
    return numbers;
  }

  Result<double> next(const char* what) {
    if (at_ == values_.size()) {
      return bad_input(fmt::format("{}: ends before {}: it isn't what OCamCalib writes", path_, what));
    }
    return values_[at_++];
  }

  /// A count, and so many numbers.
  Result<std::vector<double>> list(const char* what) {
    const Result<double> count = next(what);
    if (!count) return count.error();
    constexpr double kMax = 100;
    if (*count < 1.0 || *count > kMax || *count != std::floor(*count)) {
      return bad_input(fmt::format("{}: {} should be so many: {}", path_, what, *count));
    }
    std::vector<double> values;
    for (int k = 0; k < static_cast<int>(*count); ++k) {
      const Result<double> value = next(what);
      if (!value) return value.error();
      values.push_back(*value);
    }
    return values;
  }

 private:
  explicit OcamNumbers(std::string path) : path_(std::move(path)) {}
  std::string path_;
  std::vector<double> values_;
  std::size_t at_ = 0;
};

}  // namespace

const std::vector<CameraModelFormat>& camera_model_formats() {
  static const std::vector<CameraModelFormat> formats = {
      {"pinhole", {"fx", "fy", "cx", "cy", "distortion"}, read_pinhole, write_pinhole},
      {"kannala_brandt", {"fx", "fy", "cx", "cy", "distortion"}, read_kannala_brandt, write_kannala_brandt},
      {"ocam", {"polynomial", "cx", "cy", "affine"}, read_ocam, write_ocam}};
  return formats;
}

bool is_ocam_results(const std::string& text) {
  for (const Line& line : split_lines(text)) {
    const std::vector<std::string_view> words = split_words(line.text);
    if (words.empty() || words.front().starts_with('#')) continue;
    return parse_number(words.front()).has_value();
  }
  return false;
}

Result<CameraPtr> parse_ocam_results(const std::string& text, const std::string& path, const ImageSize& images) {
  Result<OcamNumbers> numbers = OcamNumbers::of(text, path);
  if (!numbers) return numbers.error();
  OcamParameters p;
  const Result<std::vector<double>> polynomial = numbers->list("the polynomial");
  if (!polynomial) return polynomial.error();
  p.polynomial = *polynomial;
  // The inverse polynomial is read over: the camera inverts the other one.
  if (const auto inverse = numbers->list("the inverse polynomial"); !inverse) return inverse.error();
  double height = 0.0;
  double width = 0.0;
  const NamedTarget rest[] = {
      {"the centre's row", &p.cy}, {"the centre's column", &p.cx}, {"c", &p.c}, {"d", &p.d}, {"e", &p.e},
      {"the height", &height},     {"the width", &width}};
  for (const auto& [what, target] : rest) {
    const Result<double> value = numbers->next(what);
    if (!value) return value.error();
    *target = *value;
  }
  if (images.width > 0 && (width != images.width || height != images.height)) {
    return bad_input(fmt::format("{}: {}x{}, but the images are {}x{}: this is the calibration of other images", path,
                                 width, height, images.width, images.height));
  }
  constexpr double kMaxSide = 65535.0;
  if (!(width >= 1.0 && width <= kMaxSide && height >= 1.0 && height <= kMaxSide)) {
    return bad_input(fmt::format("{}: image size {}x{} must be from 1 to {}", path, width, height, kMaxSide));
  }
  Result<CameraPtr> camera = OcamCamera::create(p, static_cast<int>(width), static_cast<int>(height));
  if (!camera) return bad_input(fmt::format("{}: {}", path, camera.error().message));
  return camera;
}

}  // namespace groundscale::internal
