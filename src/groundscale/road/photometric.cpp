#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/road/photometric_internal.hpp"
#include "groundscale/road/warp_field_internal.hpp"
#include "groundscale/tracking/opencv_internal.hpp"

namespace groundscale {
namespace {

/// Room about the region for the plane to move.
constexpr int kMarginPx = 40;
/// Rounding to grey levels alone has 0.3.
constexpr double kMinSd = 0.3;

/// The region with room about it, its corner a multiple of `unit`.
cv::Rect area_of(const Image& region, int unit) {
  const cv::Rect bounds = cv::boundingRect(view_of(region));
  const int x = std::max(0, bounds.x - kMarginPx) / unit * unit;
  const int y = std::max(0, bounds.y - kMarginPx) / unit * unit;
  const cv::Rect area(x, y, bounds.br().x + kMarginPx - x, bounds.br().y + kMarginPx - y);
  return area & cv::Rect(0, 0, region.width(), region.height());
}

cv::Mat smoothed(const cv::Mat& image, const DenseOptions& options, int level) {
  cv::Mat grey;
  image.convertTo(grey, CV_32F);
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

/// Grey levels and their derivatives by full pixels, and a float to spare. Central differences: unlike the slope of
/// what is interpolated, they don't share the noise of the pixel itself.
cv::Mat with_derivatives(const cv::Mat& grey, double scale) {
  cv::Mat by_x;
  cv::Mat by_y;
  cv::Sobel(grey, by_x, CV_32F, 1, 0, 1, 0.5 / scale);
  cv::Sobel(grey, by_y, CV_32F, 0, 1, 1, 0.5 / scale);
  const cv::Mat none = cv::Mat::zeros(grey.size(), CV_32F);
  cv::Mat merged;
  cv::merge(std::vector<cv::Mat>{grey, by_x, by_y, none}, merged);
  return merged;
}

/// How far a pixel of the second image reaches: by the Gauss filter or those of the smaller sizes, the derivative and
/// the interpolation, in the first image, which road stretches out of in the second.
double reach_px(const DenseOptions& options, int level) {
  constexpr double kStretch = 1.5;
  const double filter = level == 0 ? 3.0 * options.smooth_px : 2.0 * ((1 << level) - 1);
  return kStretch * (filter + 2.0 * (1 << level));
}

/// Whether a pixel lies inside by `border` pixels.
bool well_inside(const Eigen::Vector2d& pixel, const Camera& camera, double border) {
  return pixel.x() >= border && pixel.y() >= border && pixel.x() <= camera.width() - 1 - border &&
         pixel.y() <= camera.height() - 1 - border;
}

}  // namespace

struct PhotometricLevel::Sample {
  double grey = 0.0;
  Eigen::Vector2d by_pixel;
};

PhotometricLevel::PhotometricLevel(const RoadObservations& observations, const PhotometricState& start,
                                   const DenseOptions& options, int level)
    : camera_(observations.camera), scale_(1 << level), ray1_of_ray2_(start.homography().inverse()) {
  const int unit = 1 << level;
  const Image& region = observations.region;
  area_ = area_of(region, unit);
  const cv::Mat first = smoothed(view_of(observations.images[0])(area_), options, level);

  const double pixels = cv::countNonZero(view_of(region)) / (scale_ * scale_);
  const int stride = unit * std::max(1, static_cast<int>(std::lround(std::sqrt(pixels / options.max_pixels))));
  const Eigen::Matrix3d homography = start.homography();
  const double border = reach_px(options, level);
  std::map<int, int> square_of;
  for (int y = area_.y; y < area_.br().y; y += stride) {
    for (int x = area_.x; x < area_.br().x; x += stride) {
      if (region.at(x, y) == 0) continue;
      const auto ray = camera_->ray({x, y});
      const auto pixel2 = ray ? camera_->project(homography * *ray) : std::nullopt;
      if (!pixel2 || !well_inside(*pixel2, *camera_, border)) continue;
      const double weight = observations.weight_of_ray ? observations.weight_of_ray(*ray) : 1.0;
      constexpr double kMinWeight = 0.01;
      if (weight < kMinWeight) continue;
      const int cell = y / options.square_px * region.width() + x / options.square_px;
      const int square = square_of.try_emplace(cell, static_cast<int>(square_of.size())).first->second;
      pixels_.push_back({*ray, first.at<float>((y - area_.y) / unit, (x - area_.x) / unit), weight, square});
    }
  }
  factors_.assign(square_of.size(), 1.0);
  if (pixels_.empty()) return;
  const WarpField field(area_, *camera_,
                        [&](const Eigen::Vector3d& ray) -> Eigen::Vector3d { return homography * ray; });
  const Image warped = field.warp(observations.images[1]);
  second_ = with_derivatives(smoothed(view_of(warped), options, level), scale_);
}

std::optional<PhotometricLevel::Sample> PhotometricLevel::sample(const Eigen::Vector2d& pixel1) const {
  const double x = (pixel1.x() - area_.x) / scale_;
  const double y = (pixel1.y() - area_.y) / scale_;
  // Before they are integers: near the horizon pixels are as far away as one likes.
  if (!(x >= 0.0 && y >= 0.0 && x < second_.cols - 1 && y < second_.rows - 1)) return std::nullopt;
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
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
  const auto pixel1 = camera_->project(ray1_of_ray2_ * (homography * pixel.ray));
  const auto found = pixel1 ? sample(*pixel1) : std::nullopt;
  if (!found) return std::nullopt;
  return found->grey;
}

std::optional<PixelError> PhotometricLevel::error(const RoadPixel& pixel, const PhotometricState& state) const {
  const Eigen::Vector3d turned = state.motion.rotation * pixel.ray;
  const double inverse_depth = state.m.dot(pixel.ray);
  Eigen::Matrix<double, 2, 3> by_ray1;
  const auto pixel1 = camera_->project(ray1_of_ray2_ * (turned + state.motion.translation * inverse_depth), &by_ray1);
  const auto found = pixel1 ? sample(*pixel1) : std::nullopt;
  if (!found) return std::nullopt;
  const Eigen::Matrix<double, 2, 3> by_ray = by_ray1 * ray1_of_ray2_;
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

void PhotometricLevel::weigh_squares(const PhotometricState& state, double sd, const PlaneOptions& options) {
  const CauchyLoss loss{options.dense.loss_bound};
  std::vector<double> per_px2(factors_.size(), 0.0);
  for (const RoadPixel& pixel : pixels_) {
    const auto found = error(pixel, state);
    if (!found) continue;
    const double slope = state.gain * found->along_flow / sd;
    per_px2[static_cast<std::size_t>(pixel.square)] += loss.weight(found->difference / sd) * slope * slope;
  }
  const double variance = options.point_sd_px * options.point_sd_px;
  std::transform(per_px2.begin(), per_px2.end(), factors_.begin(),
                 [&](double q) { return options.dense.square_worth / (1.0 + q * variance); });
}

PhotometricSums PhotometricLevel::sums(const PhotometricState& state, double sd, double loss_bound,
                                       bool with_motion) const {
  const CauchyLoss loss{loss_bound};
  const double per_variance = 1.0 / (sd * sd);
  PhotometricSums sums;
  Eigen::Matrix<double, 5, 5> plane_information = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> plane_gradient = Eigen::Matrix<double, 5, 1>::Zero();
  for (const RoadPixel& pixel : pixels_) {
    const auto found = error(pixel, state);
    if (!found) continue;
    ++sums.pixels;
    const double relative = found->difference / sd;
    const double counts = pixel.weight * factor(pixel);
    const double weight = counts * loss.weight(relative) * per_variance;
    sums.cost += counts * loss.rho(relative);
    sums.weight += counts;
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
  return sums;
}

}  // namespace groundscale
