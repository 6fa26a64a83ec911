#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "groundscale/core/check.hpp"

namespace groundscale {

/// An 8-bit grey image, rows without gaps. Copies share their pixels, which nobody changes once the image is handed on.
class Image {
 public:
  Image() = default;
  Image(int width, int height)
      : width_(width), height_(height), pixels_(std::make_shared<std::uint8_t[]>(byte_count(width, height))) {}

  int width() const { return width_; }
  int height() const { return height_; }
  bool empty() const { return pixels_ == nullptr; }
  std::uint8_t* data() { return pixels_.get(); }
  const std::uint8_t* data() const { return pixels_.get(); }
  std::uint8_t at(int x, int y) const {
    GS_CHECK(x >= 0 && x < width_ && y >= 0 && y < height_, "pixel outside the image");
    return pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
  }

 private:
  static std::size_t byte_count(int width, int height) {
    GS_CHECK(width > 0 && height > 0, "an image has at least one pixel");
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }

  int width_ = 0;
  int height_ = 0;
  std::shared_ptr<std::uint8_t[]> pixels_;
};

}  // namespace groundscale
