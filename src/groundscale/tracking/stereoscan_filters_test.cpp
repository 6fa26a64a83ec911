#include <algorithm>
#include <cstddef>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "groundscale/core/rng.hpp"
#include "groundscale/tracking/stereoscan_internal.hpp"

namespace groundscale::internal {
namespace {

constexpr int kBlob[5][5] = {
    {-1, -1, -1, -1, -1}, {-1, 1, 1, 1, -1}, {-1, 1, 8, 1, -1}, {-1, 1, 1, 1, -1}, {-1, -1, -1, -1, -1}};
constexpr int kCorner[5][5] = {
    {-1, -1, 0, 1, 1}, {-1, -1, 0, 1, 1}, {0, 0, 0, 0, 0}, {1, 1, 0, -1, -1}, {1, 1, 0, -1, -1}};
constexpr int kAcross[5] = {1, 4, 6, 4, 1};
constexpr int kAlong[5] = {-1, -2, 0, 2, 1};

Image noise(int width, int height, std::uint64_t seed) {
  Rng rng(seed);
  Image image(width, height);
  for (int k = 0; k < width * height; ++k) image.data()[k] = static_cast<std::uint8_t>(rng.uniform(0.0, 256.0));
  return image;
}

/// Extremes of grey beside each other, which reach the ends of every filter's range.
Image extremes(int width, int height, std::uint64_t seed) {
  Image image = noise(width, height, seed);
  for (int k = 0; k < width * height; ++k) image.data()[k] = image.data()[k] < 128 ? 0 : 255;
  return image;
}

template <class Weight>
int convolved(const Image& image, int x, int y, const Weight& weight) {
  int sum = 0;
  for (int j = 0; j < 5; ++j) {
    for (int i = 0; i < 5; ++i) sum += weight(j, i) * image.at(x + i - 2, y + j - 2);
  }
  return sum;
}

int quantised(int value) {
  const int floored = value >= 0 ? value / 16 : -((-value + 15) / 16);
  return std::clamp(floored + 128, 0, 255);
}

void expect_plain_convolution(const Image& image) {
  const FilterResponses responses = filter_image(image);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const auto at = static_cast<std::size_t>(y * image.width() + x);
      const bool inside = x >= 2 && y >= 2 && x + 2 < image.width() && y + 2 < image.height();
      const auto of = [&](const auto& weight) { return inside ? convolved(image, x, y, weight) : 0; };
      ASSERT_EQ(responses.blob[at], of([](int j, int i) { return kBlob[j][i]; })) << x << ' ' << y;
      ASSERT_EQ(responses.corner[at], of([](int j, int i) { return kCorner[j][i]; })) << x << ' ' << y;
      ASSERT_EQ(responses.sobel_x[at], quantised(of([](int j, int i) { return kAcross[j] * kAlong[i]; })));
      ASSERT_EQ(responses.sobel_y[at], quantised(of([](int j, int i) { return kAlong[j] * kAcross[i]; })));
    }
  }
}

TEST(FilterImage, IsAPlainConvolution) {
  // Widths about the length of the pieces that rows are done in.
  for (const int width : {5, 6, 67, 68, 69, 131}) expect_plain_convolution(noise(width, 9, 1));
}

TEST(FilterImage, HoldsTheLargestResponses) { expect_plain_convolution(extremes(80, 60, 2)); }

TEST(FilterImage, HasNothingInAnImageSmallerThanTheFilters) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(4, 30), std::pair(30, 4)}) {
    const FilterResponses responses = filter_image(noise(width, height, 3));
    EXPECT_TRUE(std::all_of(responses.blob.begin(), responses.blob.end(), [](int value) { return value == 0; }));
    EXPECT_EQ(responses.blob.size(), static_cast<std::size_t>(width * height));
  }
}

using Place = std::tuple<int, int, int>;  // x, y, strength

/// All pixels of which nothing nearby is larger, by looking at all of it.
std::vector<Place> brute_force(const std::vector<std::int16_t>& response, const ExtremumOptions& options, int sign) {
  std::vector<Place> places;
  const auto at = [&](int x, int y) { return sign * response[static_cast<std::size_t>(y * options.width + x)]; };
  const int margin = options.n + options.border;
  for (int y = margin; y < options.height - margin; ++y) {
    for (int x = margin; x < options.width - margin; ++x) {
      bool extremum = at(x, y) >= options.min_response;
      for (int v = y - options.n; v <= y + options.n; ++v) {
        for (int u = x - options.n; u <= x + options.n; ++u) {
          const bool before = std::pair(v, u) < std::pair(y, x);
          if (at(u, v) > at(x, y) || (before && at(u, v) == at(x, y))) extremum = false;
        }
      }
      if (extremum) places.emplace_back(x, y, at(x, y));
    }
  }
  return places;
}

std::vector<Place> sorted(const std::vector<Feature>& features) {
  std::vector<Place> places;
  for (const Feature& feature : features) places.emplace_back(feature.x, feature.y, feature.strength);
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::pair(std::get<1>(a), std::get<0>(a)) < std::pair(std::get<1>(b), std::get<0>(b));
  });
  return places;
}

TEST(FindExtrema, AreThoseOfBruteForce) {
  const FilterResponses smooth = filter_image(noise(93, 71, 4));
  const FilterResponses equal = filter_image(extremes(93, 71, 5));  // many equal responses
  for (const FilterResponses& responses : {smooth, equal}) {
    for (const int n : {1, 3, 4, 9}) {
      const ExtremumOptions options{.width = 93, .height = 71, .n = n, .min_response = 60, .border = 2};
      const Extrema found = find_extrema(responses.blob, options);
      EXPECT_EQ(sorted(found.maxima), brute_force(responses.blob, options, 1)) << n;
      EXPECT_EQ(sorted(found.minima), brute_force(responses.blob, options, -1)) << n;
      EXPECT_FALSE(found.maxima.empty());
    }
  }
}

TEST(FindExtrema, WithoutRoomThereAreNone) {
  const FilterResponses responses = filter_image(noise(12, 12, 6));
  const Extrema found = find_extrema(responses.blob, {.width = 12, .height = 12, .n = 3, .border = 3});
  EXPECT_TRUE(found.maxima.empty());
  EXPECT_TRUE(found.minima.empty());
}

}  // namespace
}  // namespace groundscale::internal
