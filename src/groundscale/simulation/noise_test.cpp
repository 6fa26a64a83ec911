#include "groundscale/simulation/noise.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace groundscale {
namespace {

TEST(SmoothNoise, HasMeanZeroAndUnitVariance) {
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kSide = 300;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double value = smooth_noise(0.73 * x, 0.73 * y, 5);
      sum += value;
      squares += value * value;
    }
  }
  constexpr double kCount = kSide * kSide;
  // The mean of the lattice's 4096 values, 1/64 of sd, times 315 / 151, which the spline's own averaging is made up by:
  // 0.033, and three times that.
  EXPECT_NEAR(sum / kCount, 0.0, 0.1);
  EXPECT_NEAR(squares / kCount, 1.0, 0.05);
}

TEST(SmoothNoise, HasNoStepsAndDiffersBySeed) {
  for (const double x : {3.0, 3.25, -7.0, 1e6}) {
    constexpr double kStep = 1e-5;
    EXPECT_NEAR(smooth_noise(x - kStep, 0.4, 1), smooth_noise(x + kStep, 0.4, 1), 20.0 * kStep);  // slopes are a few
  }
  EXPECT_NE(smooth_noise(0.3, 0.4, 1), smooth_noise(0.3, 0.4, 2));
}

TEST(FractalNoise, IsNearTheAverageOverItsFootprint) {
  const FractalNoise noise{.seed = 3, .longest_m = 1.0, .octaves = 5, .first_sd = 1.0, .persistence = 0.8};
  for (const double footprint : {0.05, 0.3, 1.5}) {
    double squared_error = 0.0;
    double squared_rest = 0.0;
    constexpr int kPlaces = 60;
    for (int k = 0; k < kPlaces; ++k) {
      const double x = 0.37 * k;
      const double y = 0.11 * k;
      double average = 0.0;
      constexpr int kSide = 24;
      for (int row = 0; row < kSide; ++row) {
        for (int column = 0; column < kSide; ++column) {
          average += noise.at(x + footprint * ((column + 0.5) / kSide - 0.5),
                              y + footprint * ((row + 0.5) / kSide - 0.5), 0.0) /
                     (kSide * kSide);
        }
      }
      squared_error += std::pow(noise.at(x, y, footprint) - average, 2);
      squared_rest += std::pow(noise.at(x, y, 0.0) - average, 2);
    }
    // The middle alone can't tell the average: a rest remains, but it is much less than a bare sample's error.
    EXPECT_LT(squared_error, 0.7 * squared_rest) << footprint;
  }
}

}  // namespace
}  // namespace groundscale
