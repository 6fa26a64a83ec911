#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "groundscale/core/image.hpp"
#include "groundscale/tracking/pyramid.hpp"

namespace groundscale {

struct Pyramid::Levels {
  std::vector<cv::Mat> images;  ///< As cv::buildOpticalFlowPyramid makes them, each with its derivatives.
};

/// The pixels of an image without a copy. OpenCV has no read-only matrix: nobody may write to it.
inline cv::Mat view_of(const Image& image) {
  return {image.height(), image.width(), CV_8UC1, const_cast<std::uint8_t*>(image.data())};
}

inline cv::Point2f to_cv(const Eigen::Vector2d& pixel) {
  return {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
}
inline Eigen::Vector2d from_cv(const cv::Point2f& point) { return {point.x, point.y}; }

}  // namespace groundscale
