#include "groundscale/simulation/noise.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "groundscale/core/rng.hpp"

namespace groundscale {
namespace {

/// Bits well mixed: a step of splitmix64 (Steele, Lea, Flood 2014).
std::uint64_t mixed(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// Normal values on a lattice that repeats: looking them up is six times as fast as making each from a hash. Seeds
/// shift it, so that different seeds have nothing in common nearby.
class Lattice {
 public:
  static constexpr int kSide = 512;

  Lattice() : values_(static_cast<std::size_t>(kSide) * kSide) {
    Rng rng(0x67726f756e64ULL);
    for (float& value : values_) value = static_cast<float>(rng.normal());
  }

  const float* row(std::int64_t y) const {
    return values_.data() + static_cast<std::ptrdiff_t>(y & (kSide - 1)) * kSide;
  }

 private:
  std::vector<float> values_;
};

const Lattice& lattice() {
  static const Lattice instance;
  return instance;
}

/// Weights of the four lattice points about a place `t` (0 to 1) behind the second.
std::array<double, 4> spline_weights(double t) {
  const double u = 1.0 - t;
  return {u * u * u / 6.0, 2.0 / 3.0 - t * t * (1.0 - 0.5 * t), 2.0 / 3.0 - u * u * (1.0 - 0.5 * u), t * t * t / 6.0};
}

}  // namespace

double smooth_noise(double x, double y, std::uint64_t seed) {
  const double column = std::floor(x);
  const double row = std::floor(y);
  const auto wx = spline_weights(x - column);
  const auto wy = spline_weights(y - row);
  const std::uint64_t shift = mixed(seed);
  const std::int64_t first_column = static_cast<std::int64_t>(column) - 1 + static_cast<std::int64_t>(shift & 0xffff);
  const std::int64_t first_row = static_cast<std::int64_t>(row) - 1 + static_cast<std::int64_t>((shift >> 16) & 0xffff);
  double sum = 0.0;
  for (std::size_t j = 0; j < 4; ++j) {
    const float* values = lattice().row(first_row + static_cast<std::int64_t>(j));
    double line = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      line += wx[i] * values[(first_column + static_cast<std::int64_t>(i)) & (Lattice::kSide - 1)];
    }
    sum += wy[j] * line;
  }
  // Mean over a cell of the sum of squared weights is 151 / 315 in each direction.
  constexpr double kVariance = (151.0 / 315.0) * (151.0 / 315.0);
  static const double kScale = 1.0 / std::sqrt(kVariance);
  return kScale * sum;
}

double FractalNoise::at(double x_m, double y_m, double footprint_m) const {
  double sum = 0.0;
  double spacing = longest_m;
  double sd = first_sd;
  for (int k = 0; k < octaves; ++k) {
    // The best estimate of a patch's average from its middle is the middle's value times the mean over the patch of the
    // autocorrelation, which is close to exp(-3 tau^2 / 4) in each direction, tau in lattice spacings.
    const double ratio = footprint_m / spacing;
    constexpr double kGone = 6.0;
    if (ratio >= kGone) break;
    const double kept = std::exp(-0.115 * ratio * ratio);
    sum += kept * sd * smooth_noise(x_m / spacing, y_m / spacing, seed + static_cast<std::uint64_t>(k));
    spacing *= 0.5;
    sd *= persistence;
  }
  return sum;
}

}  // namespace groundscale
