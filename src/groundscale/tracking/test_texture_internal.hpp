#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "groundscale/core/image.hpp"
#include "groundscale/core/rng.hpp"

namespace groundscale {

/// A random texture for tests that has a value everywhere, so that an image of it shifted or warped by any amount is
/// exact but for the rounding to grey levels: a sum of waves.
class TestTexture {
 public:
  /// @param shortest  Of the wavelengths, in the unit of the coordinates; the longest is six times as long.
  explicit TestTexture(std::uint64_t seed, double shortest = 7.0) {
    Rng rng(seed);
    constexpr int kWaves = 40;
    for (int k = 0; k < kWaves; ++k) {
      const double length = shortest * std::pow(6.0, rng.uniform());
      const double angle = rng.uniform(0.0, std::numbers::pi);
      const double number = 2.0 * std::numbers::pi / length;
      waves_.push_back({number * std::cos(angle), number * std::sin(angle), rng.uniform(0.0, 2.0 * std::numbers::pi)});
    }
  }

  double at(double x, double y) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) sum += std::cos(wave.x * x + wave.y * y + wave.phase);
    return 127.0 + 8.0 * sum;  // sd 36: clipped at 3.5 sd
  }

  /// Image whose pixel (x, y) shows what lies at `place(x, y)`.
  template <class Place>
  Image render(int width, int height, const Place& place) const {
    Image image(width, height);
    std::uint8_t* pixel = image.data();
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto where = place(x, y);
        *pixel++ = static_cast<std::uint8_t>(std::lround(std::clamp(at(where.x(), where.y()), 0.0, 255.0)));
      }
    }
    return image;
  }

 private:
  struct Wave {
    double x, y, phase;
  };
  std::vector<Wave> waves_;
};

}  // namespace groundscale
