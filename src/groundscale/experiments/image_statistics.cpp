#include "groundscale/experiments/image_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include <fmt/format.h>

#include "groundscale/io/image_file.hpp"

namespace groundscale {
namespace {

constexpr int kHalfPatch = 2;
constexpr int kPatch = 2 * kHalfPatch + 1;

/// A plane through the grey levels of a patch, and what remains.
struct PatchFit {
  double level = 0.0;
  double tilt = 0.0;
  double rest_sd = 0.0;
};

PatchFit fit_patch(const Image& image, int x, int y) {
  double sum = 0.0;
  double by_x = 0.0;
  double by_y = 0.0;
  for (int j = -kHalfPatch; j <= kHalfPatch; ++j) {
    for (int i = -kHalfPatch; i <= kHalfPatch; ++i) {
      const double grey = image.at(x + i, y + j);
      sum += grey;
      by_x += i * grey;
      by_y += j * grey;
    }
  }
  constexpr double kCount = kPatch * kPatch;
  constexpr double kSumOfSquares = 50.0;  // of i over the patch
  const double level = sum / kCount;
  const double slope_x = by_x / kSumOfSquares;
  const double slope_y = by_y / kSumOfSquares;
  double squares = 0.0;
  for (int j = -kHalfPatch; j <= kHalfPatch; ++j) {
    for (int i = -kHalfPatch; i <= kHalfPatch; ++i) {
      squares += std::pow(image.at(x + i, y + j) - level - slope_x * i - slope_y * j, 2);
    }
  }
  return {level, std::hypot(slope_x, slope_y), std::sqrt(squares / (kCount - 3.0))};
}

/// Sums over images.
class Sums {
 public:
  void add(const Image& image) {
    for (int y = 1; y + 1 < image.height(); ++y) {
      for (int x = 1; x + 1 < image.width(); ++x) add_pixel(image, x, y);
    }
    for (int y = kHalfPatch; y + kHalfPatch < image.height(); y += kPatch) {
      for (int x = kHalfPatch; x + kHalfPatch < image.width(); x += kPatch) {
        constexpr double kFlat = 0.6;
        constexpr double kBand = 256.0 / ImageStatistics::kBands;
        const PatchFit fit = fit_patch(image, x, y);
        if (fit.tilt < kFlat) rest_[static_cast<std::size_t>(fit.level / kBand)].push_back(fit.rest_sd);
      }
    }
  }

  ImageStatistics result() {
    ImageStatistics statistics;
    if (pixels_ == 0.0) return statistics;
    statistics.mean = sum_ / pixels_;
    statistics.sd = std::sqrt(std::max(0.0, squares_ / pixels_ - statistics.mean * statistics.mean));
    statistics.dark_share = dark_ / pixels_;
    statistics.bright_share = bright_ / pixels_;
    statistics.gradient = gradients_ / pixels_;
    for (std::size_t band = 0; band < rest_.size(); ++band) {
      constexpr std::size_t kFewest = 200;
      constexpr double kOfPureNoise = 0.749;
      auto& rest = rest_[band];
      if (rest.size() < kFewest) continue;
      const auto quantile = rest.begin() + static_cast<std::ptrdiff_t>(rest.size() / 20);
      std::nth_element(rest.begin(), quantile, rest.end());
      statistics.noise[band] = *quantile / kOfPureNoise;
    }
    return statistics;
  }

 private:
  void add_pixel(const Image& image, int x, int y) {
    const int grey = image.at(x, y);
    constexpr int kDark = 15;
    constexpr int kBright = 250;
    pixels_ += 1.0;
    sum_ += grey;
    squares_ += static_cast<double>(grey) * grey;
    dark_ += grey <= kDark ? 1.0 : 0.0;
    bright_ += grey >= kBright ? 1.0 : 0.0;
    gradients_ += 0.5 * std::hypot(image.at(x + 1, y) - image.at(x - 1, y), image.at(x, y + 1) - image.at(x, y - 1));
  }

  double pixels_ = 0.0, sum_ = 0.0, squares_ = 0.0, dark_ = 0.0, bright_ = 0.0, gradients_ = 0.0;
  std::array<std::vector<double>, ImageStatistics::kBands> rest_;
};

}  // namespace

Result<ImageStatistics> image_statistics(const std::string& drive_folder, int frames) {
  constexpr int kStride = 10;
  Sums sums;
  for (int frame = 0; frame < frames; frame += kStride) {
    const auto image = read_image(fmt::format("{}/image_0/{:06d}.png", drive_folder, frame));
    if (!image) return image.error();
    sums.add(*image);
  }
  return sums.result();
}

Result<void> write_pair(const std::string& upper, const std::string& lower, const std::string& output) {
  const auto first = read_image(upper);
  if (!first) return first.error();
  const auto second = read_image(lower);
  if (!second) return second.error();
  constexpr int kGapPx = 4;
  Image both(std::max(first->width(), second->width()), first->height() + kGapPx + second->height());
  constexpr int kWhite = 255;
  std::memset(both.data(), kWhite, static_cast<std::size_t>(both.width()) * static_cast<std::size_t>(both.height()));
  const auto put = [&both](const Image& image, int top) {
    for (int y = 0; y < image.height(); ++y) {
      std::memcpy(both.data() + static_cast<std::ptrdiff_t>(top + y) * both.width(),
                  image.data() + static_cast<std::ptrdiff_t>(y) * image.width(),
                  static_cast<std::size_t>(image.width()));
    }
  };
  put(*first, 0);
  put(*second, first->height() + kGapPx);
  return write_image(output, both);
}

}  // namespace groundscale
