#include "groundscale/evaluation/absolute_errors.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "groundscale/evaluation/test_drives_internal.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

using internal::drive_of;
using internal::straight_drive;
using internal::stretched;

const Trajectory kTruth = drive_of({0, 30, 0, 40, 0, -60, 10}, {1, 2, 1, 3, 2, 1, 1});

Trajectory moved(Trajectory drive) {
  const RigidTransform elsewhere{exp_so3({0.3, -1.0, 0.2}), {10.0, 3.0, -2.0}};
  for (RigidTransform& pose : drive.world_from_cam) pose = elsewhere * pose;
  return drive;
}

TEST(AbsoluteErrors, OfATruthThatWasOnlyMovedAreZero) {
  const auto errors = absolute_errors(moved(kTruth), kTruth);
  ASSERT_TRUE(errors);
  EXPECT_EQ(errors->rows, 8);
  EXPECT_NEAR(errors->ate_se3_m, 0.0, 1e-12);
  EXPECT_NEAR(errors->ate_sim3_m, 0.0, 1e-12);
  EXPECT_NEAR(errors->sim3_scale, 1.0, 1e-12);
}

TEST(AbsoluteErrors, OnlySim3ForgivesAWrongScaleAndItsFactorBringsTheEstimateToTheTruth) {
  const auto errors = absolute_errors(moved(stretched(kTruth, 0.8)), kTruth);
  EXPECT_NEAR(errors->ate_sim3_m, 0.0, 1e-12);
  EXPECT_NEAR(errors->sim3_scale, 1.0 / 0.8, 1e-12);  // above 1: the estimate is too short
  EXPECT_GT(errors->ate_se3_m, 0.1);
}

TEST(AbsoluteErrors, AreThoseWorkedOutByHandOnALine) {
  // Positions 0, 1, 2 against 0, 2, 4: aligned by their means, -1, 0, 1 against -2, 0, 2.
  const auto errors = absolute_errors(straight_drive(3, 1.0), straight_drive(3, 2.0));
  EXPECT_NEAR(errors->ate_se3_m, std::sqrt(2.0 / 3.0), 1e-12);
  EXPECT_NEAR(errors->sim3_scale, 2.0, 1e-12);
}

TEST(AbsoluteErrors, NeedThreeRowsAndAnEstimateThatMoves) {
  EXPECT_EQ(absolute_errors(straight_drive(2, 1.0), straight_drive(2, 1.0)).error().code, ErrorCode::kTooFewMatches);
  EXPECT_EQ(absolute_errors(straight_drive(5, 0.0), straight_drive(5, 1.0)).error().code, ErrorCode::kTooFewMatches);
  EXPECT_EQ(absolute_errors(straight_drive(5, 1.0), straight_drive(4, 1.0)).error().code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace groundscale
