#include "groundscale/io/image_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "groundscale/core/check.hpp"
#include "groundscale/io/bytes_internal.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/image_decoder_internal.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {
namespace internal {
namespace {

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpegSignature = "\xFF\xD8\xFF";

bool starts_with(std::string_view bytes, std::string_view signature) {
  return bytes.substr(0, signature.size()) == signature;
}

std::size_t big_endian(std::string_view bytes, std::size_t at, int count) {
  std::size_t value = 0;
  for (int k = 0; k < count; ++k) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
  return value;
}

/// Chunks: length (4 bytes), type (4), data, checksum (4).
bool png_has_its_end(std::string_view bytes) {
  constexpr std::size_t kFrame = 12;
  for (std::size_t at = kPngSignature.size(); at + kFrame <= bytes.size();) {
    if (bytes.substr(at + 4, 4) == "IEND") return true;
    at += kFrame + big_endian(bytes, at, 4);
  }
  return false;
}

/// Markers: FF, code, then (but for the coded image data) a length that counts itself. In image data a byte FF is
/// followed by 00 or by a restart marker D0 to D7.
bool jpeg_has_its_end(std::string_view bytes) {
  std::size_t at = 2;
  while (at + 1 < bytes.size()) {
    const auto code = static_cast<unsigned char>(bytes[at + 1]);
    if (bytes[at] != '\xFF' || code == 0x00 || code == 0xFF || (code >= 0xD0 && code <= 0xD7)) {
      ++at;
      continue;
    }
    if (code == 0xD9) return true;
    if (at + 4 > bytes.size()) return false;
    at += 2 + big_endian(bytes, at + 2, 2);
  }
  return false;
}

double grey_a_step(const cv::Mat& first_16bit) {
  double highest = 0.0;
  cv::minMaxLoc(first_16bit, nullptr, &highest);
  for (const int bits : {8, 10, 12, 14}) {
    if (highest < (1 << bits)) return 255.0 / ((1 << bits) - 1);
  }
  return 255.0 / 65535.0;
}

Image image_of(const cv::Mat& grey) {
  Image image(grey.cols, grey.rows);
  for (int y = 0; y < grey.rows; ++y) {
    std::memcpy(image.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(grey.cols), grey.ptr(y),
                static_cast<std::size_t>(grey.cols));
  }
  return image;
}

}  // namespace

std::optional<std::string> truncation(std::string_view bytes) {
  if (bytes.empty()) return "the file is empty";
  if (starts_with(bytes, kPngSignature) && !png_has_its_end(bytes)) return "truncated: the PNG's end is missing";
  if (starts_with(bytes, kJpegSignature) && !jpeg_has_its_end(bytes)) return "truncated: the JPEG's end is missing";
  return std::nullopt;
}

Result<Image> ImageDecoder::decode(std::string_view bytes) {
  if (const std::optional<std::string> reason = truncation(bytes)) return bad_input(*reason);
  try {
    const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
    // Unchanged: asked for grey, the decoders would each convert colour and 16 bit in a way of their own.
    const cv::Mat decoded = cv::imdecode(encoded, cv::IMREAD_UNCHANGED);
    if (decoded.empty()) return bad_input("can't be decoded as an image");
    return convert(decoded);
  } catch (const cv::Exception& e) {
    return bad_input(fmt::format("can't be decoded as an image ({})", e.err));
  }
}

Result<Image> ImageDecoder::convert(const cv::Mat& decoded) {
  cv::Mat grey = decoded;
  if (decoded.channels() == 3) cv::cvtColor(decoded, grey, cv::COLOR_BGR2GRAY);
  if (decoded.channels() == 4) cv::cvtColor(decoded, grey, cv::COLOR_BGRA2GRAY);
  if (grey.type() == CV_16UC1) {
    if (!grey_a_16bit_step_) grey_a_16bit_step_ = grey_a_step(grey);
    cv::Mat eight_bit;
    grey.convertTo(eight_bit, CV_8U, *grey_a_16bit_step_);
    grey = eight_bit;
  }
  if (grey.type() != CV_8UC1) return bad_input("an image must have 8 or 16 bit and 1, 3 or 4 channels");
  return image_of(grey);
}

Result<Image> ImageDecoder::read(const std::string& path) {
  if (Result<void> done = read_bytes(path, &bytes_); !done) return done.error();
  Result<Image> image = decode(bytes_);
  if (!image) return bad_input(fmt::format("{}: {}", path, image.error().message));
  return image;
}

}  // namespace internal

Result<Image> read_image(const std::string& path) { return internal::ImageDecoder().read(path); }

namespace {

constexpr float kUnitsAMetre = 256.0F;  // of a depth image

Result<std::string> encode(const cv::Mat& pixels, const std::string& ending) {
  std::vector<unsigned char> bytes;
  try {
    if (!cv::imencode(ending, pixels, bytes)) return Error{ErrorCode::kIo, "the image can't be encoded"};
  } catch (const cv::Exception& e) {
    return Error{ErrorCode::kIo, fmt::format("the image can't be encoded ({})", e.err)};
  }
  return std::string(bytes.begin(), bytes.end());
}

}  // namespace

Result<std::string> encode_image(const Image& image, const std::string& ending) {
  return encode(cv::Mat(image.height(), image.width(), CV_8U, const_cast<std::uint8_t*>(image.data())), ending);
}

Result<std::string> encode_depth(const std::vector<float>& depths_m, int width, int height) {
  GS_CHECK(depths_m.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height), "a depth a pixel");
  constexpr float kLargest = 65535.0F;
  cv::Mat pixels(height, width, CV_16U);
  auto* pixel = pixels.ptr<std::uint16_t>();
  for (const float depth : depths_m) {
    const float units = std::round(kUnitsAMetre * depth);
    *pixel++ = units > 0.0F && units <= kLargest ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
  }
  return encode(pixels, ".png");
}

Result<DepthImage> read_depth(const std::string& path) {
  const auto bytes = read_text(path);
  if (!bytes) return bytes.error();
  cv::Mat pixels;
  try {
    const cv::Mat encoded(1, static_cast<int>(bytes->size()), CV_8U, const_cast<char*>(bytes->data()));
    if (!bytes->empty()) pixels = cv::imdecode(encoded, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    pixels.release();
  }
  if (pixels.type() != CV_16UC1 || pixels.empty()) {
    return internal::bad_input(fmt::format("{}: isn't a depth image (16-bit grey PNG)", path));
  }
  DepthImage image{pixels.cols, pixels.rows, {}};
  image.depths_m.reserve(pixels.total());
  for (int y = 0; y < pixels.rows; ++y) {
    const auto* row = pixels.ptr<std::uint16_t>(y);
    for (int x = 0; x < pixels.cols; ++x) image.depths_m.push_back(static_cast<float>(row[x]) / kUnitsAMetre);
  }
  return image;
}

Result<void> write_image(const std::string& path, const Image& image) {
  const std::size_t dot = path.rfind('.');
  const auto bytes = encode_image(image, dot == std::string::npos ? "" : path.substr(dot));
  if (!bytes) return Error{bytes.error().code, path + ": " + bytes.error().message};
  return write_text(path, *bytes);
}

}  // namespace groundscale
