#include "groundscale/evaluation/kitti_errors.hpp"

#include <cmath>
#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/core/rng.hpp"
#include "groundscale/evaluation/test_drives_internal.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/io/trajectory_file.hpp"

namespace groundscale {
namespace {

using internal::drive_of;
using internal::kRadPerDeg;
using internal::straight_drive;
using internal::stretched;

TEST(KittiErrors, OnAStraightPathOfOneMetreStepsAreTwoPercentTimesChordOverLength) {
  const Trajectory truth = straight_drive(301, 1.0);
  const auto errors = kitti_errors(stretched(truth, 1.02), truth);
  ASSERT_TRUE(errors);
  // A segment ends at the first row past its length: 101 m for 100 m, 201 m for 200 m. 300 m would need row 301.
  const auto& of_100m = errors->by_length[0].errors;
  const auto& of_200m = errors->by_length[1].errors;
  ASSERT_TRUE(of_100m && of_200m);
  EXPECT_FALSE(errors->by_length[2].errors);
  EXPECT_EQ(of_100m->segments, 20);  // starts 0, 10, ..., 190
  EXPECT_EQ(of_200m->segments, 10);  // starts 0, 10, ..., 90
  EXPECT_NEAR(of_100m->t_rel, 0.02 * 101.0 / 100.0, 1e-12);
  EXPECT_NEAR(of_200m->t_rel, 0.02 * 201.0 / 200.0, 1e-12);
  EXPECT_EQ(errors->all->segments, 30);
  EXPECT_NEAR(errors->all->t_rel, (20.0 * 0.0202 + 10.0 * 0.0201) / 30.0, 1e-12);
  EXPECT_NEAR(errors->all->r_rel_rad_per_m, 0.0, 1e-12);
}

TEST(KittiErrors, CountAShortEstimateAsMuchAsALongOne) {
  const Trajectory truth = straight_drive(201, 1.0);
  EXPECT_NEAR(kitti_errors(stretched(truth, 0.98), truth)->all->t_rel, 0.0202, 1e-12);
}

TEST(KittiErrors, RotationIsTheAngleAtTheEndOfASegmentOverItsLength) {
  const Trajectory truth = straight_drive(201, 1.0);
  Trajectory rolling = truth;  // about the direction of travel, so that positions stay
  for (int row = 0; row < rolling.size(); ++row) {
    rolling.world_from_cam[row].rotation = exp_so3({0.0, 0.0, 0.01 * kRadPerDeg * row});
  }
  const auto errors = kitti_errors(rolling, truth);
  EXPECT_NEAR(errors->all->r_rel_rad_per_m, 1.01 * kRadPerDeg / 100.0, 1e-12);  // 101 steps of 0.01 deg
  EXPECT_NEAR(errors->all->t_rel, 0.0, 1e-12);
}

TEST(KittiErrors, DoNotChangeWhenTheWholeEstimateIsMoved) {
  const Trajectory truth = drive_of(std::vector<double>(400, 0.3), std::vector<double>(400, 0.9));
  const Trajectory estimate = drive_of(std::vector<double>(400, 0.29), std::vector<double>(400, 0.93));
  const RigidTransform elsewhere{exp_so3({0.3, -1.0, 0.2}), {100.0, 3.0, -20.0}};
  Trajectory moved = estimate;
  for (RigidTransform& pose : moved.world_from_cam) pose = elsewhere * pose;
  EXPECT_GT(kitti_errors(estimate, truth)->all->t_rel, 0.03);
  EXPECT_NEAR(kitti_errors(moved, truth)->all->t_rel, kitti_errors(estimate, truth)->all->t_rel, 1e-10);
}

TEST(KittiErrors, AreThoseOfTheDevkitsOwnSlowSearchOnADriveThatStopsAndTurns) {
  Rng rng(4);
  std::vector<double> true_yaws_deg, true_steps_m, yaws_deg, steps_m;
  for (int k = 0; k < 500; ++k) {
    const bool stands = k % 100 > 90;
    true_steps_m.push_back(stands ? 0.0 : rng.uniform(0.3, 1.5));
    true_yaws_deg.push_back(stands ? 0.0 : rng.normal());
    steps_m.push_back(true_steps_m.back() * rng.uniform(0.9, 1.1));
    yaws_deg.push_back(true_yaws_deg.back() + 0.1 * rng.normal());
  }
  const Trajectory truth = drive_of(true_yaws_deg, true_steps_m);
  const Trajectory estimate = drive_of(yaws_deg, steps_m);

  double sum = 0.0;
  int segments = 0;
  for (int first = 0; first < truth.size(); first += 10) {
    for (const double length_m : {50.0, 120.0}) {
      int last = first;
      double path_m = 0.0;
      while (last + 1 < truth.size() && path_m <= length_m) path_m += true_steps_m[last++];
      if (path_m <= length_m) continue;
      const RigidTransform est = estimate.world_from_cam[first].inverse() * estimate.world_from_cam[last];
      const RigidTransform gt = truth.world_from_cam[first].inverse() * truth.world_from_cam[last];
      sum += (est.rotation.transpose() * (gt.translation - est.translation)).norm() / length_m;
      ++segments;
    }
  }
  const auto errors = kitti_errors(estimate, truth, {50.0, 120.0});
  EXPECT_EQ(errors->all->segments, segments);
  EXPECT_NEAR(errors->all->t_rel, sum / segments, 1e-12);
}

TEST(KittiErrors, OfAPathShorterThanEveryLengthAreNone) {
  const auto errors = kitti_errors(straight_drive(90, 1.0), straight_drive(90, 1.0));
  ASSERT_TRUE(errors);
  EXPECT_FALSE(errors->all);
  EXPECT_TRUE(kitti_errors(straight_drive(90, 1.0), straight_drive(90, 1.0), {50.0})->all);
}

TEST(KittiErrors, RefuseLengthsThatAreNotPositive) {
  const Trajectory drive = straight_drive(90, 1.0);
  for (const double length_m : {0.0, -100.0, std::nan("")}) EXPECT_FALSE(kitti_errors(drive, drive, {length_m}));
}

/// Real truth, stretched: figures of the devkit's definition by an independent program. The data is not part of the
/// project; GROUNDSCALE_KITTI names a folder with `full/poses/00.txt` and so on.
TEST(KittiErrors, OfKittiTruthStretchedByTwoPercentAreThoseOfAnIndependentProgram) {
  const char* folder = std::getenv("GROUNDSCALE_KITTI");
  if (folder == nullptr) GTEST_SKIP() << "GROUNDSCALE_KITTI is not set: no KITTI truth to measure on";
  const struct {
    const char* sequence;
    double t_rel_percent;
  } expected[] = {{"00", 1.233}, {"05", 1.158}, {"07", 1.237}};
  for (const auto& [sequence, t_rel_percent] : expected) {
    const auto truth = read_trajectory(std::string(folder) + "/full/poses/" + sequence + ".txt");
    ASSERT_TRUE(truth) << truth.error().message;
    const auto errors = kitti_errors(stretched(*truth, 1.02), *truth);
    ASSERT_TRUE(errors);
    EXPECT_NEAR(100.0 * errors->all->t_rel, t_rel_percent, 0.0005) << sequence;  // the figures' last digit
    EXPECT_NEAR(errors->all->r_rel_rad_per_m, 0.0, 1e-9);
  }
}

}  // namespace
}  // namespace groundscale
