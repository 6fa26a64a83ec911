#pragma once

#include <opencv2/core.hpp>

#include "groundscale/core/image.hpp"
#include "groundscale/tracking/opencv_internal.hpp"

namespace groundscale::internal {

/// A part of an image, copied. @pre It lies in the image and isn't empty.
inline Image crop(const Image& image, const cv::Rect& area) {
  Image part(area.width, area.height);
  cv::Mat view = view_of(part);
  view_of(image)(area).copyTo(view);
  return part;
}

}  // namespace groundscale::internal
