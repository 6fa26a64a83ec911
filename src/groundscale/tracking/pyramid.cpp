#include "groundscale/tracking/pyramid.hpp"

#include <opencv2/video/tracking.hpp>

#include "groundscale/tracking/opencv_internal.hpp"

namespace groundscale {

Pyramid::Pyramid(const Image& image, int levels, int window_px) : image_(image) {
  auto made = std::make_shared<Levels>();
  cv::buildOpticalFlowPyramid(view_of(image), made->images, {window_px, window_px}, levels, /*withDerivatives=*/true,
                              cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT, /*tryReuseInputImage=*/false);
  levels_ = std::move(made);
}

void use_one_thread() {
  // Setting the number again would take the arena of threads away from whoever works in it.
  if (cv::getNumThreads() != 1) cv::setNumThreads(1);
}

}  // namespace groundscale
