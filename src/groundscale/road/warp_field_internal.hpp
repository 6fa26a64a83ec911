#pragma once

#include <cstdint>
#include <functional>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/image.hpp"

namespace groundscale {

/// x2 = project(f(ray(x1))) over a rectangle of the first image, tabulated on a coarse grid and interpolated. Tracking
/// uses the same interpolation on the way in and out, so its error (below 0.01 px) shifts a patch, not a match.
class WarpField {
 public:
  /// @param ray2_of_ray1  f, from rays of view 1 to those of view 2, of any length; a homography for a plane.
  WarpField(const cv::Rect& area, const Camera& camera,
            const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& ray2_of_ray1);

  /// Pixel of the second image for one of the first.
  Eigen::Vector2d at(const Eigen::Vector2d& pixel1) const;

  /// The second image as it would look from the first view if f held for all of it.
  /// @param outside  Grey level where it would be seen beside the second image.
  Image warp(const Image& second, std::uint8_t outside = 0) const;

 private:
  static constexpr int kGridPx = 8;
  static constexpr float kOutside = -1e4F;
  cv::Rect area_;
  int columns_ = 0;
  int rows_ = 0;
  cv::Mat_<cv::Point2f> nodes_;
};

}  // namespace groundscale
