#include "groundscale/scale/gates.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/camera/mounting.hpp"

namespace groundscale {
namespace {

using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180.0;

Eigen::Vector3d pitched(double degrees) { return Mounting{degrees * kDegree, 0.0, 0.0}.normal_in_cam(); }

/// A level road 1.65 m below, seen over 6 to 18 m and 4 m of width after a step of 0.8 m.
class Refusal : public testing::Test {
 protected:
  Refusal() {
    context_.mounting_settled = true;
    context_.filter_started = true;
    context_.expected_distance_m = 0.8;
    context_.expected_log_sd = 0.02;
    candidate_.plane.height = candidate_.initial_plane.height = 1.65 / 0.8;
    candidate_.distance_m = 0.8;
    candidate_.log_sd = 0.02;
    for (int z = 6; z <= 18; z += 2) {
      for (int x = -2; x <= 2; ++x) candidate_.inlier_rays.emplace_back(Eigen::Vector3d(x, 1.65, z).normalized());
    }
  }

  std::string refused() const { return refusal(candidate_, context_, GateOptions{}); }

  GateContext context_;
  GateCandidate candidate_;
};

TEST_F(Refusal, IsEmptyForAGoodMeasurement) { EXPECT_EQ(refused(), ""); }

TEST_F(Refusal, NamesAnInitialNormalOffTheMounting) {
  candidate_.initial_plane.normal_in_cam = pitched(6.0);
  EXPECT_THAT(refused(), HasSubstr("initial normal is 6.0 deg off the mounting"));
}

TEST_F(Refusal, NamesARefinedNormalOffTheMounting) {
  candidate_.plane.normal_in_cam = pitched(-6.0);
  EXPECT_THAT(refused(), testing::StartsWith("normal is 6.0 deg off the mounting"));
}

TEST_F(Refusal, IsMilderUntilTheMountingIsFound) {
  candidate_.initial_plane.normal_in_cam = candidate_.plane.normal_in_cam = pitched(6.0);
  context_.mounting_settled = false;
  EXPECT_EQ(refused(), "");
  candidate_.plane.normal_in_cam = pitched(13.0);
  EXPECT_THAT(refused(), HasSubstr("normal is 13.0 deg off the mounting"));
}

TEST_F(Refusal, NamesANormalOffTheMeanOfTheDrive) {
  candidate_.plane.normal_in_cam = pitched(3.0);
  EXPECT_THAT(refused(), HasSubstr("3.0 deg off the mean of the drive"));
  context_.mean_normal = pitched(1.0);
  EXPECT_EQ(refused(), "");
}

TEST_F(Refusal, NamesAnUncertainStep) {
  candidate_.log_sd = 0.11;
  EXPECT_THAT(refused(), HasSubstr("uncertain by 11.0 %"));
  candidate_.log_sd = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refused(), HasSubstr("uncertain"));
}

TEST_F(Refusal, NamesInliersInOneLineAcrossTheRoad) {
  candidate_.inlier_rays.clear();
  for (int x = -2; x <= 2; ++x) candidate_.inlier_rays.emplace_back(x, 1.65, 9.0);
  EXPECT_THAT(refused(), HasSubstr("one line across the road"));
  candidate_.inlier_rays.clear();
  EXPECT_THAT(refused(), HasSubstr("one line across the road"));
}

TEST_F(Refusal, NamesInliersInOneLineAlongTheRoad) {
  candidate_.inlier_rays.clear();
  for (int z = 6; z <= 18; ++z) candidate_.inlier_rays.emplace_back(0.02 * (z % 3), 1.65, z);
  EXPECT_THAT(refused(), HasSubstr("one line along the road"));
}

TEST_F(Refusal, NamesALowSpeed) {
  candidate_.distance_m = 0.04;
  candidate_.plane.height = 1.65 / 0.04;
  EXPECT_THAT(refused(), HasSubstr("speed 0.40 m/s is too low"));
}

TEST_F(Refusal, NamesAStepThatNoVehicleMakes) {
  // 6 m/s^2 over a tenth of a second is 0.06 m of the next step, and 3 sd of 2.8 % another 0.07 m.
  candidate_.distance_m = 0.92;
  EXPECT_EQ(refused(), "");
  candidate_.distance_m = 0.94;
  EXPECT_THAT(refused(), HasSubstr("step of 0.94 m where 0.80 m were expected"));
  candidate_.distance_m = 0.66;
  EXPECT_THAT(refused(), HasSubstr("step of 0.66 m"));
  context_.filter_started = false;
  EXPECT_EQ(refused(), "");
}

TEST_F(Refusal, AfterAHaltAStepMayBeManyTimesWhatWasExpected) {
  // What is left of a step after a halt is known within a factor of e^1.4 at best.
  context_.expected_distance_m = 0.02;
  context_.expected_log_sd = 1.4;
  EXPECT_EQ(refused(), "");
  context_.expected_log_sd = 0.1;
  EXPECT_THAT(refused(), HasSubstr("where 0.02 m were expected"));
}

}  // namespace
}  // namespace groundscale
