#include "groundscale/tracking/detect.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "groundscale/core/check.hpp"
#include "groundscale/tracking/opencv_internal.hpp"

namespace groundscale {
namespace {

/// The rectangle that holds all of a mask, the whole image where there is none.
cv::Rect extent(const Image& image, const Image& mask, int border) {
  const cv::Rect inside(border, border, image.width() - 2 * border, image.height() - 2 * border);
  if (mask.empty()) return inside;
  return cv::boundingRect(view_of(mask)) & inside;
}

constexpr int kBlock = 5;  // px, side of the window that second moments are summed over

/// What cornerMinEigenVal returns where the gradient's rms in the weaker direction is `gradient` grey levels a pixel.
float response_of(double gradient) {
  // OpenCV sums (Sobel / (4 * block * 255))^2 over the block, and its Sobel is 8 times the gradient.
  const double scaled = 8.0 * gradient / (4.0 * kBlock * 255.0);
  return static_cast<float>(kBlock * kBlock * scaled * scaled);
}

}  // namespace

std::vector<Eigen::Vector2d> detect_corners(const Image& image, const Image& mask,
                                            const std::vector<Eigen::Vector2d>& taken, const DetectOptions& options) {
  GS_CHECK(mask.empty() || (mask.width() == image.width() && mask.height() == image.height()), "mask of another size");
  const cv::Rect area = extent(image, mask, options.border_px);
  if (area.width < options.cell_px || area.height < 8) return {};

  cv::Mat reduced = view_of(image)(area);
  if (options.reduction > 1) {
    cv::resize(reduced, reduced, {area.width / options.reduction, area.height / options.reduction}, 0, 0,
               cv::INTER_AREA);
  }
  cv::Mat response;
  cv::cornerMinEigenVal(reduced, response, kBlock, 3);
  const cv::Mat wanted = mask.empty() ? cv::Mat() : view_of(mask);

  const int cell = std::max(2, options.cell_px / options.reduction);
  const int columns = (reduced.cols + cell - 1) / cell;
  const int rows = (reduced.rows + cell - 1) / cell;
  std::vector<char> occupied(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
  for (const Eigen::Vector2d& pixel : taken) {
    const int column = static_cast<int>(std::floor((pixel.x() - area.x) / options.reduction / cell));
    const int row = static_cast<int>(std::floor((pixel.y() - area.y) / options.reduction / cell));
    if (column < 0 || row < 0 || column >= columns || row >= rows) continue;
    occupied[static_cast<std::size_t>(row * columns + column)] = 1;
  }

  const float threshold = response_of(options.min_gradient);
  std::vector<Eigen::Vector2d> corners;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (occupied[static_cast<std::size_t>(row * columns + column)] != 0) continue;
      float best = threshold;
      cv::Point where(-1, -1);
      for (int y = row * cell; y < std::min(reduced.rows, (row + 1) * cell); ++y) {
        const float* line = response.ptr<float>(y);
        const std::uint8_t* allowed =
            wanted.empty() ? nullptr : wanted.ptr<std::uint8_t>(area.y + y * options.reduction) + area.x;
        for (int x = column * cell; x < std::min(reduced.cols, (column + 1) * cell); ++x) {
          if (line[x] <= best || (allowed != nullptr && allowed[x * options.reduction] == 0)) continue;
          best = line[x];
          where = {x, y};
        }
      }
      if (where.x < 0) continue;
      const double offset = 0.5 * (options.reduction - 1);
      corners.emplace_back(area.x + where.x * options.reduction + offset,
                           area.y + where.y * options.reduction + offset);
    }
  }
  return corners;
}

}  // namespace groundscale
