#pragma once

#include <memory>

#include "groundscale/core/image.hpp"

namespace groundscale {

/// An image with its half, quarter, ... sizes, as the tracker needs them. Cheap to copy: levels are shared.
class Pyramid {
 public:
  struct Levels;  ///< OpenCV's own form, in pyramid_internal.hpp.

  Pyramid() = default;
  /// @param levels   Number of reductions beneath the full size.
  /// @param window_px  Border that tracking windows may reach into.
  Pyramid(const Image& image, int levels, int window_px);

  bool empty() const { return levels_ == nullptr; }
  const Levels& levels() const { return *levels_; }
  const Image& image() const { return image_; }

 private:
  Image image_;
  std::shared_ptr<const Levels> levels_;
};

/// OpenCV's own threads off: results must not depend on their number. Called by whoever starts a pipeline, and before
/// another thread of the process uses OpenCV (images read ahead), since OpenCV can't change their number under its
/// feet.
void use_one_thread();

}  // namespace groundscale
