#include "groundscale/evaluation/steps.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/evaluation/test_drives_internal.hpp"

namespace groundscale {
namespace {

using internal::drive_of;
using internal::kRadPerDeg;
using internal::straight_drive;
using internal::with_times;
using testing::HasSubstr;

std::vector<Step> steps_of(const Trajectory& estimate, const Trajectory& truth) {
  const auto steps = compare_steps(estimate, truth);
  EXPECT_TRUE(steps);
  return *steps;
}

std::vector<int> turns_of(const Trajectory& truth) {
  std::vector<int> turns;
  const std::vector<Step> steps = steps_of(truth, truth);
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (steps[k].turn) turns.push_back(static_cast<int>(k));
  }
  return turns;
}

TEST(Steps, AreTheDistancesBetweenNeighboursInBothAndTheirRatioIsEstimateOverTruth) {
  const std::vector<Step> steps = steps_of(drive_of({0, 0, 0}, {1.1, 2.0, 2.7}), drive_of({0, 0, 0}, {1.0, 2.0, 3.0}));
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_NEAR(steps[0].ratio(), 1.1, 1e-12);
  EXPECT_NEAR(steps[2].ratio(), 0.9, 1e-12);
  EXPECT_NEAR(steps[2].estimated_m, 2.7, 1e-12);
  EXPECT_NEAR(steps[1].true_distance_m, 3.0, 1e-12);
  EXPECT_NEAR(steps[2].true_distance_m, 6.0, 1e-12);
}

TEST(Steps, MoveWhenFasterThanTwoMetresASecondWhateverTheFrameRate) {
  const Trajectory truth = drive_of({0, 0, 0}, {0.99, 1.01, 0.3});
  for (const Step& step : steps_of(truth, with_times(truth, 0.1))) EXPECT_TRUE(step.moving);
  const std::vector<Step> slow = steps_of(truth, with_times(truth, 0.5));
  EXPECT_FALSE(slow[0].moving);
  EXPECT_TRUE(slow[1].moving);
  EXPECT_FALSE(slow[2].moving);
}

TEST(Steps, MoveWhenLongerThanTwentyCentimetresWhereThereAreNoTimes) {
  const Trajectory truth = drive_of({0, 0}, {0.199, 0.201});
  const std::vector<Step> steps = steps_of(truth, truth);
  EXPECT_FALSE(steps[0].moving);
  EXPECT_TRUE(steps[1].moving);
}

TEST(Steps, MotionIsJudgedOnTheTruthAlone) {
  const std::vector<Step> steps = steps_of(straight_drive(3, 5.0), straight_drive(3, 0.1));
  EXPECT_FALSE(steps[0].moving);
  EXPECT_FALSE(steps[1].moving);
}

TEST(Steps, OneSharpStepMakesATurnOfTheFiveAroundItOnceTheirMeanReachesTheLimit) {
  const std::vector<double> ones(11, 1.0);
  std::vector<double> yaws_deg(11, 0.0);
  yaws_deg[5] = 4.99;
  EXPECT_THAT(turns_of(drive_of(yaws_deg, ones)), testing::IsEmpty());
  yaws_deg[5] = 5.01;
  EXPECT_THAT(turns_of(drive_of(yaws_deg, ones)), testing::ElementsAre(3, 4, 5, 6, 7));
  yaws_deg[5] = -5.01;
  EXPECT_THAT(turns_of(drive_of(yaws_deg, ones)), testing::ElementsAre(3, 4, 5, 6, 7));
}

TEST(Steps, YawThatSwingsBackIsNoTurn) {
  EXPECT_THAT(turns_of(drive_of({3, -3, 3, -3, 3, -3, 3, -3}, std::vector<double>(8, 1.0))),
              testing::IsSubsetOf({0, 7}));  // at the ends the mean is over three steps
}

TEST(Steps, TurnsAreARateSoTimesDecide) {
  const Trajectory truth = drive_of(std::vector<double>(8, 1.0), std::vector<double>(8, 1.0));
  EXPECT_THAT(turns_of(with_times(truth, 0.2)), testing::IsEmpty());   // 5 deg/s
  EXPECT_THAT(turns_of(with_times(truth, 0.05)), testing::SizeIs(8));  // 20 deg/s
}

TEST(Steps, ANoddingCameraDoesNotTurn) {
  Trajectory truth = straight_drive(9, 1.0);
  for (int row = 0; row < truth.size(); ++row) {
    truth.world_from_cam[row].rotation =
        Eigen::AngleAxisd(2.0 * row * kRadPerDeg, Eigen::Vector3d::UnitX()).toRotationMatrix();
  }
  EXPECT_THAT(turns_of(truth), testing::IsEmpty());
}

TEST(Steps, RotationErrorIsTheAngleBetweenTheTwoTurns) {
  const std::vector<Step> steps = steps_of(drive_of({2.0, -1.0}, {1, 1}), drive_of({1.5, -0.3}, {1, 1}));
  EXPECT_NEAR(steps[0].rotation_error_rad, 0.5 * kRadPerDeg, 1e-12);
  EXPECT_NEAR(steps[1].rotation_error_rad, 0.7 * kRadPerDeg, 1e-12);
}

TEST(Steps, DifferentLengthsAndNumbersThatAreNotFiniteAreErrorsThatSaySo) {
  const Trajectory good = straight_drive(5, 1.0);
  const auto shorter = compare_steps(good, straight_drive(4, 1.0));
  ASSERT_FALSE(shorter);
  EXPECT_THAT(shorter.error().message, HasSubstr("5 rows of estimate against 4 of truth"));
  Trajectory bad = good;
  bad.world_from_cam[2].translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(compare_steps(bad, good).error().message, HasSubstr("the estimate holds"));
  EXPECT_THAT(compare_steps(good, bad).error().message, HasSubstr("the truth holds"));
  EXPECT_FALSE(compare_steps(straight_drive(1, 1.0), straight_drive(1, 1.0)));
}

}  // namespace
}  // namespace groundscale
