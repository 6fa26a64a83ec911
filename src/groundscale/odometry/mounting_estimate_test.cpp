#include "groundscale/odometry/mounting_estimate.hpp"

#include <gtest/gtest.h>

namespace groundscale {
namespace {

TEST(MountingEstimate, KeepsWhatTheCameraFileSaysAndFollowsTheMeanBesideIt) {
  MountingEstimate estimate(0.02, 0.01, 0.03, 15);
  EXPECT_TRUE(estimate.settled());
  for (int k = 0; k < 500; ++k) estimate.accept(0.05, -0.02, 1.0);
  EXPECT_EQ(estimate.mounting().pitch_rad, 0.02);
  EXPECT_EQ(estimate.mounting().roll_rad, 0.01);
  EXPECT_EQ(estimate.mounting().yaw_rad, 0.03);
  // 450 measurements at a gain of a fiftieth leave 1e-4 of the difference.
  EXPECT_LT((estimate.mean_normal() - Mounting{0.05, -0.02, 0.0}.normal_in_cam()).norm(), 1e-4);
}

TEST(MountingEstimate, IsFoundAfterEnoughWeight) {
  MountingEstimate estimate(std::nullopt, std::nullopt, std::nullopt, 15);
  for (int k = 0; k < 14; ++k) estimate.accept(0.08, 0.01, 1.0);
  EXPECT_FALSE(estimate.settled());
  estimate.accept(0.08, 0.01, 1.0);
  EXPECT_TRUE(estimate.settled());
  // A level camera counts as one measurement: the mean of one 0 and 15 others.
  EXPECT_NEAR(estimate.mounting().pitch_rad, 0.08 * 15.0 / 16.0, 1e-12);
}

TEST(MountingEstimate, OfMeasurementsInTurnsTakesLonger) {
  MountingEstimate estimate(std::nullopt, std::nullopt, std::nullopt, 15);
  for (int k = 0; k < 59; ++k) estimate.accept(0.08, 0.0, 0.25);
  EXPECT_FALSE(estimate.settled());
  estimate.accept(0.08, 0.0, 0.25);
  EXPECT_TRUE(estimate.settled());
}

}  // namespace
}  // namespace groundscale
