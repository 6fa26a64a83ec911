#include "groundscale/evaluation/scale_errors.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace groundscale {
namespace {

constexpr double kTolerance = 1e-12;  // a few roundings of numbers near 1

TEST(ScaleErrors, AreThoseWorkedOutByHandOnFiveSteps) {
  const auto errors = scale_errors({1.0, 1.1, 0.9, 1.2, 1.04});
  ASSERT_TRUE(errors);
  EXPECT_EQ(errors->steps, 5);
  EXPECT_NEAR(errors->bias, 0.04, kTolerance);              // median 1.04
  EXPECT_NEAR(errors->spread, 0.06 / 1.04, kTolerance);     // |r - 1.04| sorted: 0, .04, .06, .14, .16
  EXPECT_NEAR(errors->within_10_percent, 0.6, kTolerance);  // the first three
  EXPECT_NEAR(errors->mean, 0.44 / 5.0, kTolerance);        // .0 + .1 + .1 + .2 + .04
  EXPECT_NEAR(errors->p95, 0.1 + 0.8 * 0.1, kTolerance);    // position 0.95 * 4 = 3.8, between .1 and .2
}

TEST(ScaleErrors, OfAnEvenCountTakeTheMiddleOfTheTwoMiddleOnes) {
  EXPECT_NEAR(scale_errors({0.9, 1.2, 1.0, 1.3})->bias, 0.1, kTolerance);
}

TEST(ScaleErrors, BiasIsPositiveWhereStepsAreTooLong) {
  EXPECT_NEAR(scale_errors({1.02, 1.02, 1.02})->bias, 0.02, kTolerance);
  EXPECT_NEAR(scale_errors({0.97, 0.97, 0.97})->bias, -0.03, kTolerance);
}

TEST(ScaleErrors, SpreadAndShareAreAboutTheMedianAndSoBlindToACommonFactor) {
  const auto errors = scale_errors({1.0, 1.05, 1.1, 1.3});
  const auto tripled = scale_errors({3.0, 3.15, 3.3, 3.9});
  EXPECT_NEAR(errors->spread, tripled->spread, kTolerance);
  EXPECT_NEAR(errors->within_10_percent, tripled->within_10_percent, kTolerance);
  EXPECT_NEAR(tripled->bias, 3.0 * (1.0 + errors->bias) - 1.0, kTolerance);
}

TEST(ScaleErrors, RmsOfTheLogarithmIsAboutOneNotAboutTheMedian) {
  EXPECT_NEAR(scale_errors({std::exp(0.1), std::exp(0.1), std::exp(0.1)})->rms_log, 0.1, kTolerance);
  EXPECT_NEAR(scale_errors({std::exp(0.3), std::exp(-0.4)})->rms_log, std::sqrt(0.125), kTolerance);
}

TEST(ScaleErrors, OfNoStepsOrOfAnEstimateThatStandsStillAreNone) {
  EXPECT_FALSE(scale_errors({}));
  EXPECT_FALSE(scale_errors({0.0, 0.0, 1.0}));
}

TEST(ScaleDrift, IsTheSlopeOfAnExponentialGrowthAndTheStartIsLeftOut) {
  std::vector<RatioAt> ratios{{1.0, 9.0}, {4.9, 0.1}};  // below 5 m: wild, and of no effect
  for (int k = 0; k < 40; ++k) ratios.push_back({5.0 + 3.0 * k, 1.3 * std::exp(0.0012 * (5.0 + 3.0 * k))});
  const auto drift = scale_drift(ratios);
  ASSERT_TRUE(drift);
  EXPECT_EQ(drift->steps, 40);
  EXPECT_NEAR(drift->log_per_m, 0.0012, kTolerance);
}

TEST(ScaleDrift, IsNegativeWhereStepsShrinkAndLeavesOutStepsOfNothing) {
  const auto drift = scale_drift({{10.0, 1.0}, {20.0, 0.0}, {110.0, std::exp(-0.05)}});
  ASSERT_TRUE(drift);
  EXPECT_EQ(drift->steps, 2);
  EXPECT_NEAR(drift->log_per_m, -0.0005, kTolerance);
}

TEST(ScaleDrift, NeedsTwoPlaces) {
  EXPECT_FALSE(scale_drift({}));
  EXPECT_FALSE(scale_drift({{10.0, 1.0}}));
  EXPECT_FALSE(scale_drift({{10.0, 1.0}, {10.0, 1.1}}));
}

}  // namespace
}  // namespace groundscale
