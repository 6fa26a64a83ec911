#include "groundscale/calibration/speed_pairs.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "groundscale/calibration/test_drive_internal.hpp"

namespace groundscale {
namespace {

using internal::TestDrive;

TEST(SpeedPairs, PiecesAreAboutASecondAndNeverHoldAGap) {
  TestDrive drive;
  drive.log_interval_s = 0.1;
  Rng rng(1);
  auto samples = drive.samples(rng);
  samples.erase(samples.begin() + 203, samples.begin() + 240);
  const SpeedLog log = SpeedLog::create(samples).value();
  const auto pieces = pieces_of(log);
  ASSERT_EQ(log.gaps().size(), 1U);
  for (const LogPiece& piece : pieces) {
    EXPECT_NEAR(piece.to_s - piece.from_s, 1.0, 1e-6);
    EXPECT_TRUE(piece.to_s <= log.gaps()[0].from_s || piece.from_s >= log.gaps()[0].to_s);
    EXPECT_NEAR(piece.way_m, log.distance_m(piece.from_s, piece.to_s).value(), 1e-9);
  }
  EXPECT_EQ(pieces.size(), 20U + 95U);
}

TEST(SpeedPairs, PairsAreMeanSpeedsOverTheSameTime) {
  TestDrive drive;
  drive.step_noise = drive.log_noise_mps = 0.0;
  drive.log_interval_s = 0.05;
  Rng rng(1);
  const Odometer odometer = drive.odometer(rng);
  const auto pairs = pairs_at(pieces_of(drive.log(rng)), odometer, drive.clock_ahead_s);
  EXPECT_GT(pairs.size(), 115U);
  // Left: trapezoids of 0.05 s and steps of 0.1 s against a speed that changes by up to 3 m/s^2.
  for (const SpeedPair& pair : pairs) EXPECT_NEAR(pair.log_mps, drive.ratio * pair.driven_mps, 0.02);
}

TEST(SpeedPairs, RatioIsExactWithoutNoise) {
  const std::vector<SpeedPair> pairs = {{0, 1, 11, 10}, {1, 1, 5.5, 5}, {2, 1, 0, 0}, {3, 1, 16.5, 15}};
  const RatioFit fit = fit_ratio(pairs, {});
  EXPECT_NEAR(fit.ratio, 1.1, 1e-12);
  EXPECT_NEAR(fit.cost, 0.0, 1e-12);
}

TEST(SpeedPairs, RatioBalancesWhatIsLeftOver) {
  Rng rng(3);
  std::vector<SpeedPair> pairs;
  for (int k = 0; k < 60; ++k) {
    const double driven = rng.uniform(2.0, 14.0);
    const double outlier = k % 10 == 0 ? 3.0 : 0.0;
    pairs.push_back({static_cast<double>(k), 1.0, 1.3 * driven + 0.2 * rng.normal() + outlier, driven});
  }
  const SpeedNoise noise{.log_mps = 0.2, .driven_relative = 0.0};
  const RatioFit fit = fit_ratio(pairs, noise);
  // What is left, clipped at two sd, falls with the ratio: by brute force to where it changes its sign.
  double balanced = 0.0;
  for (double ratio = 1.2; ratio < 1.4 && balanced == 0.0; ratio += 1e-5) {
    double sum = 0.0;
    for (const SpeedPair& pair : pairs) sum += std::clamp(pair.log_mps - ratio * pair.driven_mps, -0.4, 0.4);
    if (sum < 0.0) balanced = ratio;
  }
  EXPECT_NEAR(fit.ratio, balanced, 1e-4);
  EXPECT_NEAR(fit.ratio, 1.3, 0.02);  // outliers of 3 m/s in a tenth of the pairs would make it 1.34
}

TEST(SpeedPairs, ErrorsOfTheDrivenSpeedDoNotMakeTheRatioSmaller) {
  // With 20 % of noise a straight line by least squares would be 4 % low. Their mean over 20 000 is 0.2 %.
  Rng rng(4);
  std::vector<SpeedPair> pairs;
  for (int k = 0; k < 20000; ++k) {
    const double speed = rng.uniform(4.0, 14.0);
    pairs.push_back({0.0, 1.0, speed + 0.2 * rng.normal(), speed * (1.0 + 0.2 * rng.normal())});
  }
  EXPECT_NEAR(fit_ratio(pairs, {.log_mps = 2.0, .driven_relative = 0.0}).ratio, 1.0, 0.006);
}

TEST(SpeedPairs, NoiseIsItsRobustSd) {
  Rng rng(5);
  std::vector<SpeedPair> pairs;
  for (int k = 0; k < 4000; ++k) pairs.push_back({0.0, 1.0, 10.0 + (k % 20 == 0 ? 8.0 : 0.2 * rng.normal()), 10.0});
  EXPECT_NEAR(noise_about(pairs, 1.0), 0.2, 0.02);  // 5 % of outliers add 7 %
}

}  // namespace
}  // namespace groundscale
