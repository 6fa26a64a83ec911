#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/core/image.hpp"

namespace groundscale {

struct DetectOptions {
  int cell_px = 24;           ///< At most one new point in each cell of a grid: even cover.
  double min_gradient = 2.0;  ///< Rms over 5x5 px of the gradient in its weaker direction, grey levels a pixel.
  int reduction = 1;          ///< 1: on the image; 2: on its half, four times as fast.
  int border_px = 8;
};

/// Corners (Shi, Tomasi 1994), strongest of each cell that holds none of `taken`.
/// @param mask  Where points are wanted (not 0); empty: everywhere. Of the image's size.
std::vector<Eigen::Vector2d> detect_corners(const Image& image, const Image& mask,
                                            const std::vector<Eigen::Vector2d>& taken, const DetectOptions& options);

}  // namespace groundscale
