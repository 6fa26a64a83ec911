#include <algorithm>
#include <cstddef>
#include <cstring>

#include "groundscale/tracking/stereoscan_internal.hpp"

namespace groundscale::internal {
namespace {

/// A stretch of one row of all responses. In arrays of their own and of fixed length, so that the compiler knows that
/// nothing overlaps and does eight columns at a time. Everything fits 16 bits: blob is at most 16 * 255, corner
/// 8 * 255, Sobel 48 * 255.
class Stretch {
 public:
  static constexpr int kLength = 64;

  /// @param top    The first of five rows, two columns before the stretch.
  /// @param count  Of columns wanted, at most kLength.
  void compute(const std::uint8_t* top, std::ptrdiff_t stride, int count) {
    for (int k = 0; k < 5; ++k) std::memcpy(rows_[k], top + k * stride, static_cast<std::size_t>(count) + 4);
    sum_columns();
    sum_rows();
  }

  std::int16_t blob[kLength];
  std::int16_t corner[kLength];
  std::uint8_t sobel_x[kLength];
  std::uint8_t sobel_y[kLength];

 private:
  void sum_columns() {
    for (int x = 0; x < kLength + 4; ++x) {
      const std::int16_t a = rows_[0][x];
      const std::int16_t b = rows_[1][x];
      const std::int16_t c = rows_[2][x];
      const std::int16_t d = rows_[3][x];
      const std::int16_t e = rows_[4][x];
      middle_[x] = c;
      inner_[x] = static_cast<std::int16_t>(b + c + d);
      all_[x] = static_cast<std::int16_t>(a + b + c + d + e);
      step_[x] = static_cast<std::int16_t>(d + e - a - b);
      smooth_[x] = static_cast<std::int16_t>(a + e + 4 * (b + d) + 6 * c);
      slope_[x] = static_cast<std::int16_t>(e - a + 2 * (d - b));
    }
  }

  void sum_rows() {
    for (int x = 0; x < kLength; ++x) {
      const auto core = static_cast<std::int16_t>(inner_[x + 1] + inner_[x + 2] + inner_[x + 3]);
      const auto whole = static_cast<std::int16_t>(all_[x] + all_[x + 1] + all_[x + 2] + all_[x + 3] + all_[x + 4]);
      blob[x] = static_cast<std::int16_t>(2 * core - whole + 7 * middle_[x + 2]);
      corner[x] = static_cast<std::int16_t>(step_[x] + step_[x + 1] - step_[x + 3] - step_[x + 4]);
    }
    for (int x = 0; x < kLength; ++x) {
      const auto right = static_cast<std::int16_t>(smooth_[x + 4] - smooth_[x] + 2 * (smooth_[x + 3] - smooth_[x + 1]));
      const auto down = static_cast<std::int16_t>(slope_[x] + slope_[x + 4] + 4 * (slope_[x + 1] + slope_[x + 3]) +
                                                  6 * slope_[x + 2]);
      sobel_x[x] = quantised(right);
      sobel_y[x] = quantised(down);
    }
  }

  static std::uint8_t quantised(std::int16_t response) {
    const auto value = static_cast<std::int16_t>((response >> 4) + 128);
    return static_cast<std::uint8_t>(std::clamp<int>(value, 0, 255));
  }

  std::uint8_t rows_[5][kLength + 4] = {};
  // Sums over the five rows, a value a column:
  std::int16_t middle_[kLength + 4];  // 0 0 1 0 0
  std::int16_t inner_[kLength + 4];   // 0 1 1 1 0
  std::int16_t all_[kLength + 4];     // 1 1 1 1 1
  std::int16_t step_[kLength + 4];    // -1 -1 0 1 1
  std::int16_t smooth_[kLength + 4];  // 1 4 6 4 1
  std::int16_t slope_[kLength + 4];   // -1 -2 0 2 1
};

}  // namespace

FilterResponses filter_image(const Image& image) {
  FilterResponses result;
  result.width = image.width();
  result.height = image.height();
  const std::ptrdiff_t width = image.width();
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(image.height());
  result.blob.assign(pixels, 0);
  result.corner.assign(pixels, 0);
  result.sobel_x.assign(pixels, 128);
  result.sobel_y.assign(pixels, 128);
  Stretch stretch;
  for (std::ptrdiff_t y = 2; y + 2 < image.height(); ++y) {
    for (std::ptrdiff_t x = 2; x + 2 < width; x += Stretch::kLength) {
      const std::ptrdiff_t count = std::min<std::ptrdiff_t>(Stretch::kLength, width - 2 - x);
      stretch.compute(image.data() + (y - 2) * width + x - 2, width, static_cast<int>(count));
      const std::ptrdiff_t at = y * width + x;
      std::copy_n(stretch.blob, count, result.blob.begin() + at);
      std::copy_n(stretch.corner, count, result.corner.begin() + at);
      std::copy_n(stretch.sobel_x, count, result.sobel_x.begin() + at);
      std::copy_n(stretch.sobel_y, count, result.sobel_y.begin() + at);
    }
  }
  return result;
}

namespace {

struct Block {
  int left = 0;
  int top = 0;
  int right = 0;  ///< The last column of it,
  int bottom = 0;
};

/// Looks at one filter's response.
class ExtremumSearch {
 public:
  ExtremumSearch(const std::vector<std::int16_t>& response, int width, int n)
      : response_(response.data()), width_(width), n_(n) {}

  int at(int x, int y) const { return response_[static_cast<std::ptrdiff_t>(y) * width_ + x]; }

  /// Whether a pixel, the first of the largest of its block, beats the rest of its neighbourhood.
  /// @param sign  1 for maxima, -1 for minima.
  bool is_extremum(int x, int y, const Block& block, int sign) const {
    const int value = sign * at(x, y);
    for (int v = y - n_; v <= y + n_; ++v) {
      const bool in_block = v >= block.top && v <= block.bottom;
      for (int u = x - n_; u <= x + n_; ++u) {
        if (in_block && u == block.left) u = block.right + 1;  // the block's own are behind us
        if (u > x + n_) break;
        const int other = sign * at(u, v);
        const bool before = v < y || (v == y && u < x);
        if (other > value || (before && other == value)) return false;
      }
    }
    return true;
  }

  void search(const Block& block, int min_response, Extrema& extrema) const {
    Feature lowest = feature(block.left, block.top, at(block.left, block.top));
    Feature highest = lowest;
    for (int y = block.top; y <= block.bottom; ++y) {
      for (int x = block.left; x <= block.right; ++x) {
        const int value = at(x, y);
        if (value < lowest.strength) {
          lowest = feature(x, y, value);
        } else if (value > highest.strength) {
          highest = feature(x, y, value);
        }
      }
    }
    if (highest.strength >= min_response && is_extremum(highest.x, highest.y, block, 1)) {
      extrema.maxima.push_back(highest);
    }
    if (-lowest.strength >= min_response && is_extremum(lowest.x, lowest.y, block, -1)) {
      lowest.strength = static_cast<std::int16_t>(-lowest.strength);
      extrema.minima.push_back(lowest);
    }
  }

 private:
  static Feature feature(int x, int y, int strength) {
    return {.x = static_cast<std::int16_t>(x),
            .y = static_cast<std::int16_t>(y),
            .strength = static_cast<std::int16_t>(strength)};
  }

  const std::int16_t* response_;
  int width_;
  int n_;
};

}  // namespace

Extrema find_extrema(const std::vector<std::int16_t>& response, const ExtremumOptions& options) {
  Extrema extrema;
  const ExtremumSearch search(response, options.width, options.n);
  const int margin = options.border + options.n;
  const int end_x = options.width - margin;
  const int end_y = options.height - margin;
  for (int top = margin; top < end_y; top += options.n + 1) {
    for (int left = margin; left < end_x; left += options.n + 1) {
      const Block block{left, top, std::min(left + options.n, end_x - 1), std::min(top + options.n, end_y - 1)};
      search.search(block, options.min_response, extrema);
    }
  }
  return extrema;
}

}  // namespace groundscale::internal
