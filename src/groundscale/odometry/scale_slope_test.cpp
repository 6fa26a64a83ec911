#include "groundscale/odometry/scale_slope.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "groundscale/core/rng.hpp"

namespace groundscale {
namespace {

/// A drive of steps of a metre whose scale runs away; neighbouring measurements share most of their error.
std::vector<FrameResult> drive(int frames, double slope_per_100m, double noise, Rng& rng) {
  std::vector<FrameResult> results(static_cast<std::size_t>(frames));
  double shared = 0.0;
  for (int k = 1; k < frames; ++k) {
    FrameResult& result = results[static_cast<std::size_t>(k)];
    constexpr double kKept = 0.8;
    shared = kKept * shared + std::sqrt(1.0 - kKept * kKept) * rng.normal();
    result.frame = k;
    result.online_step_m = 1.0;
    result.raw_over_online = 1.0;
    result.raw_sd = 0.01;
    result.map_scale = 1.0;
    result.drift_ratio = std::exp(-0.01 * slope_per_100m * k - 0.02 - noise * shared);
  }
  return results;
}

TEST(ScaleSlope, IsThatOfLengthsThatGrowTooLong) {
  Rng rng(1);
  const auto slope = scale_slope(drive(200, 0.08, 0.0, rng));
  ASSERT_TRUE(slope) << slope.error().message;
  EXPECT_NEAR(slope->per_100m, 0.08, 1e-9);
  EXPECT_NEAR(slope->length_m, 198.0, 1e-9);
  EXPECT_EQ(slope->measurements, 199);
}

TEST(ScaleSlope, ItsLineRunsThroughTheMeasurementsAcceptedAlongTheWay) {
  Rng rng(1);
  auto results = drive(200, 0.08, 0.0, rng);
  results[50].reason = "normal is off";
  const ScaleSlope slope = scale_slope(results).value();
  EXPECT_NEAR(slope.level, 0.02, 1e-9);
  ASSERT_EQ(slope.samples.size(), 198U);
  EXPECT_EQ(slope.samples[49].distance_m, 51.0);
  for (const ScaleSlope::Sample& sample : slope.samples) {
    EXPECT_NEAR(sample.log_ratio, slope.level + slope.per_100m * sample.distance_m / 100.0, 1e-9);
    EXPECT_EQ(sample.sd, 0.01);
  }
}

TEST(ScaleSlope, IsNotLedByOutliersOrRefusedMeasurements) {
  Rng rng(2);
  auto results = drive(300, 0.05, 0.003, rng);
  for (std::size_t k = 10; k < results.size(); k += 12) results[k].drift_ratio = 1.6;
  for (std::size_t k = 200; k < 230; ++k) {
    results[k].drift_ratio = 0.3;
    results[k].reason = "normal is off";
  }
  EXPECT_NEAR(scale_slope(results).value().per_100m, 0.05, 0.004);
}

TEST(ScaleSlope, OfAScaleThatFollowsTheGroundIsThatOfItsMap) {
  Rng rng(1);
  auto results = drive(200, 0.08, 0.0, rng);
  for (FrameResult& result : results) {
    if (!result.drift_ratio) continue;
    result.map_scale = *result.drift_ratio;
    result.drift_ratio = 1.0;
  }
  EXPECT_NEAR(scale_slope(results).value().per_100m, 0.08, 1e-9);
}

TEST(ScaleSlope, BeginsANewLineWhereTheMapEndsOrIsScaled) {
  Rng rng(1);
  auto results = drive(200, 0.08, 0.0, rng);
  results[80].map_scale.reset();  // bridged
  results[80].drift_ratio.reset();
  for (std::size_t k = 81; k < results.size(); ++k) *results[k].drift_ratio *= 1.5;
  for (std::size_t k = 140; k < results.size(); ++k) *results[k].drift_ratio *= 0.7;
  ScaleEvent scaled;
  scaled.frame = 140;
  const ScaleSlope slope = scale_slope(results, {scaled}).value();
  EXPECT_NEAR(slope.per_100m, 0.08, 1e-9);
  EXPECT_EQ(slope.measurements, 79 + 59 + 60);
  EXPECT_EQ(slope.samples.size(), 79U);
}

TEST(ScaleSlope, StatesAnErrorThatHoldsForCorrelatedMeasurements) {
  constexpr int kTrials = 200;
  int within = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Rng rng(static_cast<std::uint64_t>(trial) + 10);
    const ScaleSlope slope = scale_slope(drive(300, 0.02, 0.01, rng)).value();
    if (std::abs(slope.per_100m - 0.02) < 2.0 * slope.sd_per_100m) ++within;
  }
  // Of a dozen blocks: an sd from so few has tails of its own.
  EXPECT_GT(within, 0.78 * kTrials);
  EXPECT_LT(within, 0.99 * kTrials);
}

TEST(ScaleSlope, NeedsAWayAndMeasurements) {
  Rng rng(3);
  EXPECT_FALSE(scale_slope(drive(25, 0.02, 0.0, rng)));
  auto results = drive(200, 0.02, 0.0, rng);
  for (std::size_t k = 10; k < results.size(); ++k) results[k].drift_ratio.reset();
  EXPECT_FALSE(scale_slope(results));
  EXPECT_FALSE(scale_slope({}));
}

}  // namespace
}  // namespace groundscale
