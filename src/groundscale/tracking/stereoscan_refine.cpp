#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/LU>

#include "groundscale/tracking/stereoscan_internal.hpp"

namespace groundscale::internal {
namespace {

constexpr int kSide = 11;
constexpr int kPixels = kSide * kSide;
constexpr int kRow = 12;      ///< Rows are padded, so that four columns at a time come out even,
constexpr int kWideRow = 16;  ///< and those of the patch with a rim.
constexpr int kRim = kSide + 2;

/// Interpolates a patch whose top left pixel lies `Size / 2` left and above of a point, in rows of `Row`; false where
/// it isn't all in the image.
template <int Size, int Row>
bool sample(const Image& image, const Eigen::Vector2d& point, float (&patch)[Size][Row]) {
  constexpr int kHalf = Size / 2;
  const double x0 = std::floor(point.x());
  const double y0 = std::floor(point.y());
  if (!(x0 >= kHalf && y0 >= kHalf && x0 + Row < image.width() + kHalf && y0 + Size < image.height() + kHalf)) {
    return false;
  }
  const auto a = static_cast<float>(point.x() - x0);
  const auto b = static_cast<float>(point.y() - y0);
  const std::ptrdiff_t stride = image.width();
  const std::uint8_t* corner =
      image.data() + (static_cast<std::ptrdiff_t>(y0) - kHalf) * stride + static_cast<std::ptrdiff_t>(x0) - kHalf;
  float rows[Size + 1][Row];  // interpolated along x
  for (int y = 0; y <= Size; ++y) {
    float whole[Row + 1];
    for (int x = 0; x <= Row; ++x) whole[x] = static_cast<float>(corner[y * stride + x]);
    for (int x = 0; x < Row; ++x) rows[y][x] = whole[x] + a * (whole[x + 1] - whole[x]);
  }
  for (int y = 0; y < Size; ++y) {
    for (int x = 0; x < Row; ++x) patch[y][x] = rows[y][x] + b * (rows[y + 1][x] - rows[y][x]);
  }
  return true;
}

/// Sums of four columns each: the compiler may not change the order of a sum by itself.
struct Sum {
  float lanes[4] = {};
  float total() const { return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]); }
};

/// A patch of the first image, and what it takes to align another with it.
struct Template {
  float grey[kSide][kRow];
  /// Derivatives less their means, so that a constant between the images is nothing; 0 in the padding.
  float dx[kSide][kRow], dy[kSide][kRow];
  Eigen::Matrix2f inverse;  ///< Of the sum of products of derivatives.
};

/// Central differences of a patch with a rim, less their mean.
void differentiate(const float (&wide)[kRim][kWideRow], int step_x, int step_y, float (&result)[kSide][kRow]) {
  float mean = 0.0F;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      result[y][x] = 0.5F * (wide[y + 1 + step_y][x + 1 + step_x] - wide[y + 1 - step_y][x + 1 - step_x]);
      mean += result[y][x];
    }
  }
  mean /= kPixels;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) result[y][x] -= mean;
    result[y][kSide] = 0.0F;
  }
}

float sum_of_products(const float (&a)[kSide][kRow], const float (&b)[kSide][kRow]) {
  Sum sum;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kRow; x += 4) {
      for (int k = 0; k < 4; ++k) sum.lanes[k] += a[y][x + k] * b[y][x + k];
    }
  }
  return sum.total();
}

bool make_template(const Image& image, const Eigen::Vector2d& point, Template& patch) {
  float wide[kRim][kWideRow];
  if (!sample(image, point, wide)) return false;
  for (int y = 0; y < kSide; ++y) std::copy_n(&wide[y + 1][1], kRow, patch.grey[y]);
  differentiate(wide, 1, 0, patch.dx);
  differentiate(wide, 0, 1, patch.dy);
  const float xx = sum_of_products(patch.dx, patch.dx);
  const float xy = sum_of_products(patch.dx, patch.dy);
  const float yy = sum_of_products(patch.dy, patch.dy);
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
  float present[kSide][kRow];
  for (int k = 0; k < kMaxIterations; ++k) {
    if (!sample(second, place, present)) return std::nullopt;
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kRow; ++x) present[y][x] = patch.grey[y][x] - present[y][x];
    }
    const Eigen::Vector2f gradient(sum_of_products(patch.dx, present), sum_of_products(patch.dy, present));
    const Eigen::Vector2f step = patch.inverse * gradient;
    place += step.cast<double>();
    if (!((place - start).squaredNorm() <= kMaxWayPx * kMaxWayPx)) return std::nullopt;
    if (step.squaredNorm() < kMinStepPx * kMinStepPx) return place;
  }
  return std::nullopt;
}

}  // namespace groundscale::internal
