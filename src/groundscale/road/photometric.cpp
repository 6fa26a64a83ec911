#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/road/photometric_internal.hpp"
#include "groundscale/tracking/opencv_internal.hpp"

namespace groundscale {
namespace {

/// Room for the plane to move, and for filters.
constexpr int kMarginPx = 40;
/// Rounding to grey levels alone has 0.3.
constexpr double kMinSd = 0.3;

/// Part of an image whose corner is a multiple of `unit`.
cv::Rect aligned_area(cv::Rect area, int unit, const Image& image) {
  const int x = area.x / unit * unit;
  const int y = area.y / unit * unit;
  area = cv::Rect(x, y, area.x + area.width - x, area.y + area.height - y);
  return area & cv::Rect(0, 0, image.width(), image.height());
}

cv::Mat smoothed(const Image& image, const cv::Rect& area, const DenseOptions& options, int level) {
  cv::Mat grey;
  view_of(image)(area).convertTo(grey, CV_32F);
  if (level == 0 && options.smooth_px > 0.0) {
    cv::GaussianBlur(grey, grey, {}, options.smooth_px, options.smooth_px, cv::BORDER_REFLECT_101);
  }
  for (int k = 0; k < level; ++k) {
    cv::Mat half;
    cv::pyrDown(grey, half);
    grey = half;
  }
  return grey;
}

/// Rows and columns of the region that hold a pixel of it.
cv::Rect bounds_of(const Image& region) { return cv::boundingRect(view_of(region)); }

}  // namespace

struct PhotometricLevel::Sample {
  double grey = 0.0;
  Eigen::Vector2d by_pixel;
};

PhotometricLevel::PhotometricLevel(const RoadObservations& observations, const PhotometricState& start,
                                   const DenseOptions& options, int level)
    : camera_(observations.camera), scale_(1 << level) {
  const int unit = 1 << level;
  const Image& region = observations.region;
  const cv::Rect bounds = bounds_of(region);
  const cv::Rect padded(bounds.x - kMarginPx, bounds.y - kMarginPx, bounds.width + 2 * kMarginPx,
                        bounds.height + 2 * kMarginPx);
  const cv::Rect area1 =
      aligned_area(padded & cv::Rect(0, 0, region.width(), region.height()), unit, observations.images[0]);
  const cv::Mat first = smoothed(observations.images[0], area1, options, level);

  const double area = cv::countNonZero(view_of(region)(bounds)) / (scale_ * scale_);
  const int stride = unit * std::max(1, static_cast<int>(std::lround(std::sqrt(area / options.max_pixels))));
  const Eigen::Matrix3d homography = start.homography();
  cv::Point low(region.width(), region.height());
  cv::Point high(-1, -1);
  std::map<int, int> square_of;
  for (int y = (bounds.y + stride - 1) / stride * stride; y < bounds.y + bounds.height; y += stride) {
    for (int x = (bounds.x + stride - 1) / stride * stride; x < bounds.x + bounds.width; x += stride) {
      if (region.at(x, y) == 0) continue;
      const auto ray = camera_->ray({x, y});
      const auto pixel2 = ray ? camera_->project(homography * *ray) : std::nullopt;
      if (!pixel2 || !camera_->contains(*pixel2)) continue;
      const double weight = observations.weight_of_ray ? observations.weight_of_ray(*ray) : 1.0;
      constexpr double kMinWeight = 0.01;
      if (weight < kMinWeight) continue;
      const cv::Point corner(static_cast<int>(pixel2->x()), static_cast<int>(pixel2->y()));
      low = {std::min(low.x, corner.x), std::min(low.y, corner.y)};
      high = {std::max(high.x, corner.x), std::max(high.y, corner.y)};
      const int cell = y / options.square_px * region.width() + x / options.square_px;
      const int square = square_of.try_emplace(cell, static_cast<int>(square_of.size())).first->second;
      pixels_.push_back({*ray, first.at<float>((y - area1.y) / unit, (x - area1.x) / unit), weight, square});
    }
  }
  squares_ = static_cast<int>(square_of.size());
  if (pixels_.empty()) return;
  const cv::Rect reached(low.x - kMarginPx, low.y - kMarginPx, high.x - low.x + 2 * kMarginPx,
                         high.y - low.y + 2 * kMarginPx);
  area2_ = aligned_area(reached & cv::Rect(0, 0, region.width(), region.height()), unit, observations.images[1]);
  const cv::Mat grey = smoothed(observations.images[1], area2_, options, level);
  // Central differences: unlike the slope of what is interpolated, they don't share the noise of the pixel itself.
  cv::Mat by_x;
  cv::Mat by_y;
  cv::Sobel(grey, by_x, CV_32F, 1, 0, 1, 0.5 / scale_);
  cv::Sobel(grey, by_y, CV_32F, 0, 1, 1, 0.5 / scale_);
  const cv::Mat none = cv::Mat::zeros(grey.size(), CV_32F);
  cv::merge(std::vector<cv::Mat>{grey, by_x, by_y, none}, second_);
}

std::optional<PhotometricLevel::Sample> PhotometricLevel::sample(const Eigen::Vector2d& pixel2) const {
  const double x = (pixel2.x() - area2_.x) / scale_;
  const double y = (pixel2.y() - area2_.y) / scale_;
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  if (!(x >= 0.0 && y >= 0.0) || column + 1 >= second_.cols || row + 1 >= second_.rows) return std::nullopt;
  const auto fx = static_cast<float>(x - column);
  const auto fy = static_cast<float>(y - row);
  const auto node = [](const float* at) { return Eigen::Map<const Eigen::Vector4f>(at); };
  const float* top = second_.ptr<float>(row) + 4 * column;
  const float* low = second_.ptr<float>(row + 1) + 4 * column;
  const Eigen::Vector4f above = node(top) + fx * (node(top + 4) - node(top));
  const Eigen::Vector4f below = node(low) + fx * (node(low + 4) - node(low));
  const Eigen::Vector4f value = above + fy * (below - above);
  return Sample{value[0], {value[1], value[2]}};
}

std::optional<double> PhotometricLevel::grey2(const RoadPixel& pixel, const Eigen::Matrix3d& homography) const {
  const auto pixel2 = camera_->project(homography * pixel.ray);
  const auto found = pixel2 ? sample(*pixel2) : std::nullopt;
  if (!found) return std::nullopt;
  return found->grey;
}

std::optional<PixelError> PhotometricLevel::error(const RoadPixel& pixel, const PhotometricState& state) const {
  const Eigen::Vector3d turned = state.motion.rotation * pixel.ray;
  const double inverse_depth = state.m.dot(pixel.ray);
  Eigen::Matrix<double, 2, 3> by_ray;
  const auto pixel2 = camera_->project(turned + state.motion.translation * inverse_depth, &by_ray);
  const auto found = pixel2 ? sample(*pixel2) : std::nullopt;
  if (!found) return std::nullopt;
  PixelError error;
  error.grey2 = found->grey;
  error.difference = pixel.grey - state.gain * found->grey - state.offset;
  const Eigen::Vector3d slope = by_ray.transpose() * found->by_pixel;  // grey levels by the ray
  const double by_t = slope.dot(state.motion.translation);
  const double flow = (by_ray * state.motion.translation).norm();
  error.along_flow = flow > 0.0 ? by_t / flow : 0.0;
  const Eigen::Vector3d brighter = state.gain * slope;
  error.by_state << turned.cross(brighter), inverse_depth * brighter, state.gain * by_t * pixel.ray, found->grey, 1.0;
  return error;
}

double PhotometricLevel::robust_sd(const PhotometricState& state) const {
  const Eigen::Matrix3d homography = state.homography();
  std::vector<double> differences;
  differences.reserve(pixels_.size());
  for (const RoadPixel& pixel : pixels_) {
    const auto grey = grey2(pixel, homography);
    if (grey) differences.push_back(std::abs(pixel.grey - state.gain * *grey - state.offset));
  }
  if (differences.empty()) return kMinSd;
  constexpr double kSdByMad = 1.4826;
  return std::max(kMinSd, kSdByMad * quantile(std::move(differences), 0.5));
}

double PhotometricLevel::correlation(const Eigen::Matrix3d& homography) const {
  double n = 0.0;
  double all = 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  for (const RoadPixel& pixel : pixels_) {
    all += pixel.weight;
    const auto grey = grey2(pixel, homography);
    if (!grey) continue;
    const Eigen::Vector2d pair(pixel.grey, *grey);
    n += pixel.weight;
    sum += pixel.weight * pair;
    squares += pixel.weight * pair * pair.transpose();
  }
  constexpr double kMinShare = 0.2;
  if (!(n > kMinShare * all)) return -1.0;
  const Eigen::Matrix2d spread = squares - sum * sum.transpose() / n;
  const double both = spread(0, 0) * spread(1, 1);
  return both > 0.0 ? spread(0, 1) / std::sqrt(both) : -1.0;
}

void PhotometricLevel::match_brightness(PhotometricState& state) const {
  const Eigen::Matrix3d homography = state.homography();
  double n = 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Vector2d squares = Eigen::Vector2d::Zero();
  for (const RoadPixel& pixel : pixels_) {
    const auto grey = grey2(pixel, homography);
    if (!grey) continue;
    const Eigen::Vector2d pair(pixel.grey, *grey);
    n += pixel.weight;
    sum += pixel.weight * pair;
    squares += pixel.weight * pair.cwiseAbs2();
  }
  if (!(n > 0.0)) return;
  const Eigen::Vector2d mean = sum / n;
  const Eigen::Vector2d variance = squares / n - mean.cwiseAbs2();
  constexpr double kMaxGain = 2.0;
  const double ratio = variance.y() > 0.0 && variance.x() > 0.0 ? std::sqrt(variance.x() / variance.y()) : 1.0;
  state.gain = std::clamp(ratio, 1.0 / kMaxGain, kMaxGain);
  state.offset = mean.x() - state.gain * mean.y();
}

PhotometricSums PhotometricLevel::sums(const PhotometricState& state, double sd, double loss_bound,
                                       bool with_motion) const {
  const CauchyLoss loss{loss_bound};
  const double per_variance = 1.0 / (sd * sd);
  PhotometricSums sums;
  std::vector<double> of_squares(static_cast<std::size_t>(squares_), 0.0);
  Eigen::Matrix<double, 5, 5> plane_information = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> plane_gradient = Eigen::Matrix<double, 5, 1>::Zero();
  for (const RoadPixel& pixel : pixels_) {
    const auto found = error(pixel, state);
    if (!found) continue;
    ++sums.pixels;
    const double relative = found->difference / sd;
    const double weight = pixel.weight * loss.weight(relative) * per_variance;
    sums.cost += pixel.weight * loss.rho(relative);
    sums.weight += pixel.weight;
    const double slope = state.gain * found->along_flow;
    of_squares[static_cast<std::size_t>(pixel.square)] += weight * slope * slope;
    if (with_motion) {
      sums.information.noalias() += weight * found->by_state * found->by_state.transpose();
      sums.gradient.noalias() -= weight * found->difference * found->by_state;
    } else {
      const auto by_plane = found->by_state.tail<5>();
      plane_information.noalias() += weight * by_plane * by_plane.transpose();
      plane_gradient.noalias() -= weight * found->difference * by_plane;
    }
  }
  if (!with_motion) {
    sums.information.bottomRightCorner<5, 5>() = plane_information;
    sums.gradient.tail<5>() = plane_gradient;
  }
  if (sums.weight > 0.0) sums.cost /= sums.weight;
  double squared = 0.0;
  for (const double per_px2 : of_squares) {
    sums.per_px2 += per_px2;
    squared += per_px2 * per_px2;
  }
  if (squared > 0.0) sums.effective_squares = sums.per_px2 * sums.per_px2 / squared;
  return sums;
}

}  // namespace groundscale
