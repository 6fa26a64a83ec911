#include <algorithm>
#include <cstddef>

#include "groundscale/tracking/stereoscan_internal.hpp"

namespace groundscale::internal {
namespace {

/// Sums over five rows of the image, a value a column.
struct ColumnSums {
  explicit ColumnSums(std::size_t width) : all(width), inner(width), step(width), smooth(width), slope(width) {}
  std::vector<std::int16_t> all;     ///< 1 1 1 1 1
  std::vector<std::int16_t> inner;   ///< 0 1 1 1 0
  std::vector<std::int16_t> step;    ///< -1 -1 0 1 1
  std::vector<std::int16_t> smooth;  ///< 1 4 6 4 1
  std::vector<std::int16_t> slope;   ///< -1 -2 0 2 1
};

/// @param top  The first of five rows.
void sum_columns(const std::uint8_t* top, int width, ColumnSums& sums) {
  const std::uint8_t* rows[5];
  for (int k = 0; k < 5; ++k) rows[k] = top + static_cast<std::ptrdiff_t>(k) * width;
  std::int16_t* __restrict all = sums.all.data();
  std::int16_t* __restrict inner = sums.inner.data();
  std::int16_t* __restrict step = sums.step.data();
  std::int16_t* __restrict smooth = sums.smooth.data();
  std::int16_t* __restrict slope = sums.slope.data();
  for (int x = 0; x < width; ++x) {
    const int a = rows[0][x];
    const int b = rows[1][x];
    const int c = rows[2][x];
    const int d = rows[3][x];
    const int e = rows[4][x];
    inner[x] = static_cast<std::int16_t>(b + c + d);
    all[x] = static_cast<std::int16_t>(a + b + c + d + e);
    step[x] = static_cast<std::int16_t>(d + e - a - b);
    smooth[x] = static_cast<std::int16_t>(a + e + 4 * (b + d) + 6 * c);
    slope[x] = static_cast<std::int16_t>(e - a + 2 * (d - b));
  }
}

std::uint8_t quantised(int response) { return static_cast<std::uint8_t>(std::clamp((response >> 4) + 128, 0, 255)); }

}  // namespace

// Everything fits 16 bits: blob at most 16 * 255, corner 8 * 255, Sobel 48 * 255.
FilterResponses filter_image(const Image& image) {
  FilterResponses result;
  result.width = image.width();
  result.height = image.height();
  const auto width = static_cast<std::size_t>(image.width());
  const std::size_t count = width * static_cast<std::size_t>(image.height());
  result.blob.assign(count, 0);
  result.corner.assign(count, 0);
  result.sobel_x.assign(count, 128);
  result.sobel_y.assign(count, 128);
  ColumnSums sums(width);
  const std::int16_t* all = sums.all.data();
  const std::int16_t* inner = sums.inner.data();
  const std::int16_t* step = sums.step.data();
  const std::int16_t* smooth = sums.smooth.data();
  const std::int16_t* slope = sums.slope.data();
  for (int y = 2; y + 2 < image.height(); ++y) {
    const std::uint8_t* middle = image.data() + static_cast<std::size_t>(y) * width;
    sum_columns(middle - 2 * image.width(), image.width(), sums);
    const std::size_t row = static_cast<std::size_t>(y) * width;
    std::int16_t* __restrict blob = &result.blob[row];
    std::int16_t* __restrict corner = &result.corner[row];
    std::uint8_t* __restrict sobel_x = &result.sobel_x[row];
    std::uint8_t* __restrict sobel_y = &result.sobel_y[row];
    for (int x = 2; x + 2 < image.width(); ++x) {
      const int core = inner[x - 1] + inner[x] + inner[x + 1];
      const int whole = all[x - 2] + all[x - 1] + all[x] + all[x + 1] + all[x + 2];
      blob[x] = static_cast<std::int16_t>(2 * core - whole + 7 * middle[x]);
      corner[x] = static_cast<std::int16_t>(step[x - 2] + step[x - 1] - step[x + 1] - step[x + 2]);
      sobel_x[x] = quantised(smooth[x + 2] - smooth[x - 2] + 2 * (smooth[x + 1] - smooth[x - 1]));
      sobel_y[x] = quantised(slope[x - 2] + slope[x + 2] + 4 * (slope[x - 1] + slope[x + 1]) + 6 * slope[x]);
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
