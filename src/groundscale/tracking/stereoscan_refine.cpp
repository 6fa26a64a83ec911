#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/LU>

#include "groundscale/tracking/stereoscan_internal.hpp"

namespace groundscale::internal {
namespace {

constexpr int kSide = 11;
constexpr int kPixels = kSide * kSide;

/// Square of `Size` pixels about a point, interpolated; false where it isn't all in the image.
template <int Size>
bool sample(const Image& image, const Eigen::Vector2d& point, float (&patch)[Size][Size]) {
  constexpr int kHalf = Size / 2;
  const double x0 = std::floor(point.x());
  const double y0 = std::floor(point.y());
  const int left = static_cast<int>(x0) - kHalf;
  const int top = static_cast<int>(y0) - kHalf;
  if (left < 0 || top < 0 || left + Size >= image.width() || top + Size >= image.height()) return false;
  const auto a = static_cast<float>(point.x() - x0);
  const auto b = static_cast<float>(point.y() - y0);
  const std::ptrdiff_t stride = image.width();
  for (int y = 0; y < Size; ++y) {
    const std::uint8_t* upper = image.data() + (top + y) * stride + left;
    const std::uint8_t* lower = upper + stride;
    float column[Size + 1];
    for (int x = 0; x <= Size; ++x) {
      column[x] = static_cast<float>(upper[x]) + b * static_cast<float>(lower[x] - upper[x]);
    }
    for (int x = 0; x < Size; ++x) patch[y][x] = column[x] + a * (column[x + 1] - column[x]);
  }
  return true;
}

/// A patch of the first image, what it takes to align another with it.
struct Template {
  float grey[kSide][kSide];
  float dx[kSide][kSide], dy[kSide][kSide];  ///< Less their means, so that a constant between the images is nothing.
  Eigen::Matrix2f inverse;                   ///< Of the sum of products of derivatives.
};

bool make_template(const Image& image, const Eigen::Vector2d& point, Template& patch) {
  float wide[kSide + 2][kSide + 2];
  if (!sample(image, point, wide)) return false;
  float mean_x = 0.0F;
  float mean_y = 0.0F;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      patch.grey[y][x] = wide[y + 1][x + 1];
      patch.dx[y][x] = 0.5F * (wide[y + 1][x + 2] - wide[y + 1][x]);
      patch.dy[y][x] = 0.5F * (wide[y + 2][x + 1] - wide[y][x + 1]);
      mean_x += patch.dx[y][x];
      mean_y += patch.dy[y][x];
    }
  }
  mean_x /= kPixels;
  mean_y /= kPixels;
  float xx = 0.0F;
  float xy = 0.0F;
  float yy = 0.0F;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const float dx = patch.dx[y][x] -= mean_x;
      const float dy = patch.dy[y][x] -= mean_y;
      xx += dx * dx;
      xy += dx * dy;
      yy += dy * dy;
    }
  }
  constexpr float kMinGradient = 0.3F;  // rms in the weaker direction, grey levels a pixel
  const float weaker = 0.5F * (xx + yy - std::hypot(xx - yy, 2.0F * xy));
  if (weaker < kMinGradient * kMinGradient * kPixels) return false;
  patch.inverse << yy, -xy, -xy, xx;
  patch.inverse /= xx * yy - xy * xy;
  return true;
}

}  // namespace

std::optional<Eigen::Vector2d> refine_match(const Image& first, const Image& second, const Eigen::Vector2d& point,
                                            const Eigen::Vector2d& start) {
  constexpr int kMaxIterations = 10;
  constexpr float kMinStepPx = 0.01F;
  constexpr double kMaxWayPx = 1.5;
  Template patch;
  if (!make_template(first, point, patch)) return std::nullopt;
  Eigen::Vector2d place = start;
  float present[kSide][kSide];
  for (int k = 0; k < kMaxIterations; ++k) {
    if (!sample(second, place, present)) return std::nullopt;
    Eigen::Vector2f gradient(0.0F, 0.0F);
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const float residual = patch.grey[y][x] - present[y][x];
        gradient.x() += patch.dx[y][x] * residual;
        gradient.y() += patch.dy[y][x] * residual;
      }
    }
    const Eigen::Vector2f step = patch.inverse * gradient;
    place += step.cast<double>();
    if (!((place - start).squaredNorm() <= kMaxWayPx * kMaxWayPx)) return std::nullopt;
    if (step.squaredNorm() < kMinStepPx * kMinStepPx) return place;
  }
  return std::nullopt;
}

}  // namespace groundscale::internal
