#include "groundscale/estimation/robust.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace groundscale {
namespace {

TEST(Quantile, IsAValueOfTheSortedListWithoutInterpolation) {
  const std::vector<double> values{40.0, 10.0, 30.0, 0.0, 20.0};
  EXPECT_EQ(quantile(values, 0.0), 0.0);
  EXPECT_EQ(quantile(values, 0.25), 10.0);
  EXPECT_EQ(quantile(values, 0.7), 30.0);  // 0.7 * 4 = 2.8, the nearest place is 3
  EXPECT_EQ(quantile(values, 1.0), 40.0);
}

TEST(Quantile, OfAFractionBeyondTheRangeIsTheNearestEnd) {
  EXPECT_EQ(quantile({1.0, 2.0, 3.0}, -0.5), 1.0);
  EXPECT_EQ(quantile({1.0, 2.0, 3.0}, 7.0), 3.0);
}

TEST(Median, IsTheMiddleOrTheMeanOfTheMiddleTwo) {
  EXPECT_EQ(median({5.0}), 5.0);
  EXPECT_EQ(median({3.0, 100.0, 1.0}), 3.0);
  EXPECT_EQ(median({4.0, -1.0, 2.0, 100.0}), 3.0);
}

TEST(Median, OfNothingIsNotANumber) {
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

template <class Loss>
void expect_weight_is_slope_over_residual(const Loss& loss) {
  constexpr double kStep = 1e-6;
  for (const double r : {-7.0, -1.3, -0.4, 0.05, 0.6, 1.1, 5.0, 300.0}) {
    const double slope = (loss.rho(r + kStep) - loss.rho(r - kStep)) / (2.0 * kStep);
    // Rounding of rho (1e-16 of up to 150) over the step; the truncation error is of the step's square.
    EXPECT_NEAR(loss.weight(r), slope / r, 1e-7) << "r = " << r;
  }
}

TEST(HuberLoss, WeightIsTheSlopeOverTheResidual) { expect_weight_is_slope_over_residual(HuberLoss{0.5}); }
TEST(CauchyLoss, WeightIsTheSlopeOverTheResidual) { expect_weight_is_slope_over_residual(CauchyLoss{0.5}); }

TEST(HuberLoss, IsASquareWithinItsBoundAndALineBeyond) {
  const HuberLoss loss{2.0};
  EXPECT_DOUBLE_EQ(loss.rho(1.0), 0.5);
  EXPECT_DOUBLE_EQ(loss.rho(-2.0), 2.0);
  EXPECT_DOUBLE_EQ(loss.rho(5.0), 8.0);  // 2 (5 - 1)
}

TEST(Losses, HaveFullWeightWithoutAResidual) {
  EXPECT_EQ(HuberLoss{0.5}.weight(0.0), 1.0);
  EXPECT_EQ(CauchyLoss{0.5}.weight(0.0), 1.0);
}

}  // namespace
}  // namespace groundscale
