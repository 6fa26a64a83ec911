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

/// Weights of the four lattice points about a place `t` (0 to 1) behind the second.
std::array<double, 4> spline_weights(double t) {
  const double u = 1.0 - t;
  return {u * u * u / 6.0, 2.0 / 3.0 - t * t * (1.0 - 0.5 * t), 2.0 / 3.0 - u * u * (1.0 - 0.5 * u), t * t * t / 6.0};
}

/// std::floor is a call on processors of the base level.
std::int64_t floor_of(double value) {
  const auto whole = static_cast<std::int64_t>(value);
  return whole - (static_cast<double>(whole) > value ? 1 : 0);
}

/// The spline through normal values on a lattice that repeats, at kFine places a lattice spacing: straight lines
/// between those are 2 % of an sd from the spline itself, and take a quarter of its time. Seeds shift it, so that
/// different seeds have nothing in common nearby.
class Field {
 public:
  static constexpr int kLattice = 64;
  static constexpr int kFine = 4;
  static constexpr int kSide = kLattice * kFine;

  Field() : values_(static_cast<std::size_t>(kSide) * kSide) {
    std::vector<double> lattice(static_cast<std::size_t>(kLattice) * kLattice);
    Rng rng(0x67726f756e64ULL);
    for (double& value : lattice) value = rng.normal();
    std::array<std::array<double, 4>, kFine> weights;
    for (std::size_t k = 0; k < kFine; ++k) weights[k] = spline_weights(static_cast<double>(k) / kFine);
    for (std::size_t y = 0; y < kSide; ++y) {
      for (std::size_t x = 0; x < kSide; ++x) {
        double sum = 0.0;
        for (std::size_t j = 0; j < 4; ++j) {
          for (std::size_t i = 0; i < 4; ++i) {
            const std::size_t row = (y / kFine + j) % kLattice;
            const std::size_t column = (x / kFine + i) % kLattice;
            sum += weights[y % kFine][j] * weights[x % kFine][i] * lattice[row * kLattice + column];
          }
        }
        values_[y * kSide + x] = static_cast<float>(sum);
      }
    }
    const double scale = 1.0 / std::sqrt(mean_square());
    for (float& value : values_) value = static_cast<float>(scale * value);
  }

  float at(std::int64_t x, std::int64_t y) const {
    constexpr std::int64_t kMask = kSide - 1;
    return values_[static_cast<std::size_t>((y & kMask) * kSide + (x & kMask))];
  }

 private:
  /// Over the whole plane, of what is straight between the values in both directions.
  double mean_square() const {
    double sum = 0.0;
    for (std::int64_t y = 0; y < kSide; ++y) {
      for (std::int64_t x = 0; x < kSide; ++x) {
        const double a = at(x, y);
        const double b = at(x + 1, y);
        const double c = at(x, y + 1);
        const double d = at(x + 1, y + 1);
        sum += (a * a + b * b + c * c + d * d + a * b + b * d + d * c + c * a) / 9.0 + (a * d + b * c) / 18.0;
      }
    }
    return sum / (static_cast<double>(kSide) * kSide);
  }

  std::vector<float> values_;
};

}  // namespace

std::uint64_t cell_seed(std::int64_t column, std::int64_t row, std::uint64_t seed) {
  return mixed(mixed(mixed(seed) + static_cast<std::uint64_t>(column)) + static_cast<std::uint64_t>(row));
}

double cell_value(std::int64_t column, std::int64_t row, std::uint64_t seed) {
  return static_cast<double>(cell_seed(column, row, seed) >> 11) * 0x1.0p-53;
}

double smooth_noise(double x, double y, std::uint64_t seed) {
  static const Field field;
  const std::uint64_t shift = mixed(seed);
  const double fine_x = x * Field::kFine + static_cast<double>(shift & 0xffff);
  const double fine_y = y * Field::kFine + static_cast<double>((shift >> 16) & 0xffff);
  const std::int64_t i = floor_of(fine_x);
  const std::int64_t j = floor_of(fine_y);
  const auto share_x = static_cast<float>(fine_x - static_cast<double>(i));
  const auto share_y = static_cast<float>(fine_y - static_cast<double>(j));
  const float above = field.at(i, j) + share_x * (field.at(i + 1, j) - field.at(i, j));
  const float below = field.at(i, j + 1) + share_x * (field.at(i + 1, j + 1) - field.at(i, j + 1));
  return static_cast<double>(above + share_y * (below - above));
}

double FractalNoise::at(double x_m, double y_m, double footprint_m) const {
  // Each octave is turned against the one before, and the first against the road: their repetitions never coincide.
  constexpr double kCos = 0.6;
  constexpr double kSin = 0.8;
  double x = (kCos * x_m - kSin * y_m) / longest_m;
  double y = (kSin * x_m + kCos * y_m) / longest_m;
  // The best estimate of a patch's average from its middle is the middle's value times the mean over the patch of the
  // autocorrelation, which is close to exp(-3 tau^2 / 4) in each direction, tau in lattice spacings.
  double ratio = footprint_m / longest_m;
  double kept = std::exp(-0.115 * ratio * ratio);
  double sum = 0.0;
  double sd = first_sd;
  for (int k = 0; k < octaves; ++k) {
    constexpr double kGone = 5.0;
    if (ratio >= kGone) break;
    sum += kept * sd * smooth_noise(x, y, seed + static_cast<std::uint64_t>(k));
    // Half of the spacing: twice the ratio.
    ratio *= 2.0;
    kept *= kept * kept * kept;
    sd *= persistence;
    const double turned = 2.0 * (kCos * x - kSin * y);
    y = 2.0 * (kSin * x + kCos * y);
    x = turned;
  }
  return sum;
}

}  // namespace groundscale
