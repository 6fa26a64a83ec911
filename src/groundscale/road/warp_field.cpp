#include <algorithm>
#include <optional>

#include <opencv2/imgproc.hpp>

#include "groundscale/road/warp_field_internal.hpp"
#include "groundscale/tracking/opencv_internal.hpp"

namespace groundscale {

WarpField::WarpField(const cv::Rect& area, const Camera& camera,
                     const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& ray2_of_ray1)
    : area_(area) {
  columns_ = (area.width - 1) / kGridPx + 2;
  rows_ = (area.height - 1) / kGridPx + 2;
  nodes_.create(rows_, columns_);
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const auto ray = camera.ray({area.x + column * kGridPx, area.y + row * kGridPx});
      const auto pixel = ray ? camera.project(ray2_of_ray1(*ray)) : std::nullopt;
      nodes_(row, column) = pixel ? cv::Point2f(to_cv(*pixel)) : cv::Point2f(kOutside, kOutside);
    }
  }
}

Eigen::Vector2d WarpField::at(const Eigen::Vector2d& pixel1) const {
  const double x = std::clamp((pixel1.x() - area_.x) / kGridPx, 0.0, columns_ - 1.001);
  const double y = std::clamp((pixel1.y() - area_.y) / kGridPx, 0.0, rows_ - 1.001);
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  const double fx = x - column;
  const double fy = y - row;
  const Eigen::Vector2d top = (1.0 - fx) * from_cv(nodes_(row, column)) + fx * from_cv(nodes_(row, column + 1));
  const Eigen::Vector2d low = (1.0 - fx) * from_cv(nodes_(row + 1, column)) + fx * from_cv(nodes_(row + 1, column + 1));
  return (1.0 - fy) * top + fy * low;
}

Image WarpField::warp(const Image& second, std::uint8_t outside) const {
  cv::Mat map(area_.height, area_.width, CV_32FC2);
  constexpr float kStep = 1.0F / kGridPx;
  for (int y = 0; y < area_.height; ++y) {
    const int row = y / kGridPx;
    const float fy = static_cast<float>(y % kGridPx) * kStep;
    cv::Point2f* line = map.ptr<cv::Point2f>(y);
    for (int column = 0; column * kGridPx < area_.width; ++column) {
      const cv::Point2f left = nodes_(row, column) * (1.0F - fy) + nodes_(row + 1, column) * fy;
      const cv::Point2f right = nodes_(row, column + 1) * (1.0F - fy) + nodes_(row + 1, column + 1) * fy;
      const cv::Point2f step = (right - left) * kStep;
      const int count = std::min(kGridPx, area_.width - column * kGridPx);
      for (int x = 0; x < count; ++x) line[column * kGridPx + x] = left + step * static_cast<float>(x);
    }
  }
  Image warped(area_.width, area_.height);
  cv::Mat view = view_of(warped);
  cv::remap(view_of(second), view, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(outside));
  return warped;
}

}  // namespace groundscale
