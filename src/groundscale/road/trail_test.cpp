#include "groundscale/road/trail.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

const Eigen::Vector3d kNormal = Eigen::Vector3d::UnitY();
const Eigen::Vector3d kForward = Eigen::Vector3d::UnitZ();
const GroundPlane kRoad{kNormal, 1.65};
const PathAheadOptions kSteady{.heading_m = 3.0, .steady_m = 0.0};

/// Pose of a level camera `along_m` along an arc that begins at the world's origin; curvature > 0 turns right.
RigidTransform pose_on_arc(double along_m, double curvature) {
  const double turn = along_m * curvature;
  if (curvature == 0.0) return {Eigen::Matrix3d::Identity(), {0.0, 0.0, along_m}};
  return {exp_so3(turn * kNormal), {(1.0 - std::cos(turn)) / curvature, 0.0, std::sin(turn) / curvature}};
}

std::vector<RigidTransform> drive(int frames, double step_m, double curvature) {
  std::vector<RigidTransform> poses;
  for (int k = 0; k < frames; ++k) poses.push_back(pose_on_arc(step_m * k, curvature));
  return poses;
}

/// A point of the road beside the arc that the present camera, which has come `driven_m` along it, has `along_m` ahead.
Eigen::Vector3d beside_arc(double driven_m, double along_m, double aside_m, double curvature) {
  const RigidTransform there = pose_on_arc(driven_m + along_m, curvature);
  const Eigen::Vector3d in_world = there * Eigen::Vector3d(aside_m, kRoad.height, 0.0);
  return pose_on_arc(driven_m, curvature).inverse() * in_world;
}

TEST(TrailOf, IsThePastSeenFromThePresentInMetresMostRecentFirst) {
  std::vector<RigidTransform> poses = drive(20, 0.5, 0.05);
  for (RigidTransform& pose : poses) pose.translation /= 2.5;
  const Trail trail = trail_of(poses, 2.5, 100.0);
  ASSERT_EQ(trail.cam_from_past.size(), 19U);
  for (std::size_t k = 0; k < trail.cam_from_past.size(); ++k) {
    const RigidTransform expected =
        pose_on_arc(9.5, 0.05).inverse() * pose_on_arc(9.0 - 0.5 * static_cast<double>(k), 0.05);
    EXPECT_LT((trail.cam_from_past[k].translation - expected.translation).norm(), 1e-12);
    EXPECT_LT((trail.cam_from_past[k].rotation - expected.rotation).norm(), 1e-12);
  }
}

TEST(TrailOf, GoesBackAsFarAsAskedFor) {
  for (const double unit_m : {0.1, 1.0, 4.0}) {
    std::vector<RigidTransform> poses = drive(100, 0.5, 0.0);
    for (RigidTransform& pose : poses) pose.translation /= unit_m;
    // 4.25 m back takes nine steps of half a metre.
    EXPECT_EQ(trail_of(poses, unit_m, 4.25).cam_from_past.size(), 9U);
  }
  EXPECT_TRUE(trail_of(drive(100, 0.5, 0.0), 1.0, 0.0).cam_from_past.empty());
}

TEST(TrailOf, HasNothingAtTheStart) {
  EXPECT_TRUE(trail_of({}, 1.0, 10.0).cam_from_past.empty());
  EXPECT_TRUE(trail_of(drive(1, 0.5, 0.0), 1.0, 10.0).cam_from_past.empty());
  EXPECT_TRUE(Trail{}.centres(0.8, 8.0).empty());
}

TEST(TrailCentres, KeepTheirSpacingAndEndAtTheirLength) {
  const Trail trail = trail_of(drive(100, 0.3, 0.0), 1.0, 30.0);
  const std::vector<Eigen::Vector3d> centres = trail.centres(0.8, 8.0);
  // The next multiple of the step, 0.9 m, eight times: a ninth would lie 8.1 m behind.
  ASSERT_EQ(centres.size(), 8U);
  for (std::size_t k = 0; k < centres.size(); ++k) {
    EXPECT_LT((centres[k] - Eigen::Vector3d(0.0, 0.0, -0.9 * static_cast<double>(k + 1))).norm(), 1e-12);
  }
}

TEST(TrailCentres, OfACameraThatStandsAreNone) {
  const Trail trail = trail_of(std::vector<RigidTransform>(50), 1.0, 8.0);
  EXPECT_TRUE(trail.centres(0.8, 8.0).empty());
}

TEST(TrailCentres, PassOverAHalt) {
  std::vector<RigidTransform> poses = drive(30, 0.4, 0.0);
  poses.insert(poses.end(), 40, poses.back());
  const std::vector<Eigen::Vector3d> centres = trail_of(poses, 1.0, 20.0).centres(0.7, 3.3);
  ASSERT_EQ(centres.size(), 4U);
  EXPECT_NEAR(centres.back().z(), -3.2, 1e-12);
}

TEST(PathOfTrail, IsStraightAfterAStraightAndAnArcAfterAnArc) {
  for (const double curvature : {0.0, 0.08, -0.08}) {
    const Trail trail = trail_of(drive(40, 0.25, curvature), 1.0, 10.0);
    const DrivenPath path = path_of_trail(trail, kSteady, kNormal, kForward);
    EXPECT_LT((path.forward_in_cam - kForward).norm(), 1e-9) << curvature;
    // The turn over its chord instead of its arc: (3 * 0.08)^2 / 24 is 0.24 %.
    EXPECT_NEAR(path.curvature_per_m, curvature, 0.003 * std::abs(curvature) + 1e-12);
  }
}

TEST(PathOfTrail, FollowsTheWayOfACameraThatLooksAside) {
  constexpr double kYaw = 0.1;
  std::vector<RigidTransform> poses = drive(40, 0.25, 0.05);
  for (RigidTransform& pose : poses) pose.rotation = pose.rotation * exp_so3(kYaw * kNormal);
  const DrivenPath path = path_of_trail(trail_of(poses, 1.0, 10.0), kSteady, kNormal, kForward);
  EXPECT_LT((path.forward_in_cam - Eigen::Vector3d(-std::sin(kYaw), 0.0, std::cos(kYaw))).norm(), 1e-9);
}

TEST(PathOfTrail, LooksAheadInReverseToo) {
  std::vector<RigidTransform> poses = drive(40, 0.25, 0.08);
  std::reverse(poses.begin(), poses.end());
  const DrivenPath path = path_of_trail(trail_of(poses, 1.0, 10.0), kSteady, kNormal, kForward);
  EXPECT_LT((path.forward_in_cam - kForward).norm(), 1e-9);
  EXPECT_NEAR(path.curvature_per_m, 0.08, 0.003 * 0.08);
}

TEST(PathOfTrail, IsTheMountingsWhereNothingWasDriven) {
  const Eigen::Vector3d mounted(0.1, 0.0, std::sqrt(1.0 - 0.01));
  EXPECT_LT((path_of_trail({}, kSteady, kNormal, mounted).forward_in_cam - mounted).norm(), 1e-12);
  const Trail standing = trail_of(std::vector<RigidTransform>(50), 1.0, 8.0);
  const DrivenPath path = path_of_trail(standing, kSteady, kNormal, mounted);
  EXPECT_LT((path.forward_in_cam - mounted).norm(), 1e-12);
  EXPECT_EQ(path.curvature_per_m, 0.0);
}

TEST(PathOfTrail, TakesWhatWayThereIs) {
  const DrivenPath path = path_of_trail(trail_of(drive(5, 0.25, 0.08), 1.0, 10.0), kSteady, kNormal, kForward);
  EXPECT_NEAR(path.curvature_per_m, 0.08, 0.003 * 0.08);
}

/// Weight of a point of the road beside an arc that the camera has driven 10 m of.
double weight_on_arc(double along_m, double aside_m, double curvature, double step_m = 0.25) {
  const int frames = static_cast<int>(10.0 / step_m) + 1;
  const Trail trail = trail_of(drive(frames, step_m, curvature), 1.0, 10.0);
  const DrivenPath path = path_of_trail(trail, kSteady, kNormal, kForward);
  return path_weight(beside_arc(step_m * (frames - 1), along_m, aside_m, curvature), trail, path, kRoad, {});
}

TEST(PathWeight, FallsOffBesideThePathAheadAndBehind) {
  for (const double curvature : {0.0, 0.04, -0.04}) {
    for (const double along : {-3.5, -1.0, 2.0, 9.0}) {
      for (const double aside : {-2.0, -0.5, 0.0, 1.0, 2.4}) {
        // The polyline and the curvature found are off from the arc by some millimetres.
        EXPECT_NEAR(weight_on_arc(along, aside, curvature), std::exp(-0.5 * aside * aside), 0.01)
            << along << " " << aside << " " << curvature;
      }
      EXPECT_EQ(weight_on_arc(along, 2.6, curvature), 0.0);
      EXPECT_EQ(weight_on_arc(along, -2.6, curvature), 0.0);
    }
  }
}

TEST(PathWeight, EndsAheadAndFarBehind) {
  EXPECT_GT(weight_on_arc(9.9, 0.0, 0.0), 0.99);
  EXPECT_EQ(weight_on_arc(10.1, 0.0, 0.0), 0.0);
  EXPECT_GT(weight_on_arc(-3.9, 0.0, 0.0), 0.99);
  EXPECT_EQ(weight_on_arc(-6.6, 0.0, 0.0), 0.0);
}

TEST(PathWeight, BehindDoesNotDependOnTheFrameRate) {
  for (const double along : {-1.0, -3.0, -4.5, -6.0}) {
    EXPECT_NEAR(weight_on_arc(along, 0.5, 0.0, /*step_m=*/2.5), weight_on_arc(along, 0.5, 0.0, /*step_m=*/0.1), 1e-9)
        << along;
  }
}

TEST(PathWeight, IsThatOfThePointsPlaceWhateverItsHeight) {
  const Trail trail = trail_of(drive(41, 0.25, 0.0), 1.0, 10.0);
  const DrivenPath path = path_of_trail(trail, kSteady, kNormal, kForward);
  for (const double along : {-2.0, 6.0}) {
    const double on_road = path_weight({0.8, 1.65, along}, trail, path, kRoad, {});
    for (const double down : {1.0, 1.5, 1.9}) {
      EXPECT_NEAR(path_weight({0.8, down, along}, trail, path, kRoad, {}), on_road, 1e-12);
    }
  }
}

TEST(PathWeight, BehindIsNothingWithoutATrail) {
  const DrivenPath path{kForward, 0.0};
  EXPECT_EQ(path_weight({0.0, 1.65, -1.0}, {}, path, kRoad, {}), 0.0);
  EXPECT_NEAR(path_weight({0.0, 1.65, 1.0}, {}, path, kRoad, {}), 1.0, 1e-12);
}

TEST(PathWeight, IsTheMeanOverThePathsThatATurnMayGoOnTo) {
  // After 8 m a curvature of 0.05 that changes by as much within 6 m has led 0.71 m off the arc, or as far inwards.
  DrivenPath path{kForward, 0.05};
  path.steady_m = 6.0;
  const double sd = 0.05 * 512.0 / 36.0;
  EXPECT_NEAR(path.sd_m(8.0), sd, 1e-12);
  for (const double aside : {0.0, 1.5, -1.5, 2.8}) {
    const Eigen::Vector3d point = beside_arc(0.0, 8.0, aside, 0.05);
    double sum = 0.0;
    double weights = 0.0;
    for (double off = -6.0; off <= 6.0; off += 0.01) {
      const double probability = std::exp(-0.5 * off * off);
      sum += probability * std::exp(-0.5 * std::pow(aside - sd * off, 2));
      weights += probability;
    }
    // The way to the point is taken as straight, and its offset from the arc is not quite that along the chord.
    EXPECT_NEAR(path_weight(point, {}, path, kRoad, {}), sum / weights, 0.02) << aside;
  }
  EXPECT_EQ(path_weight(beside_arc(0.0, 8.0, 3.3, 0.05), {}, path, kRoad, {}), 0.0);
  EXPECT_NEAR(path_weight({0.5, 1.65, 0.2}, {}, path, kRoad, {}), std::exp(-0.125), 0.01);
}

TEST(PathWeight, FollowsItsOptions) {
  const DrivenPath path{kForward, 0.0};
  const PathWeightOptions wide{.behind_m = 4.0, .ahead_m = 20.0, .half_width_m = 5.0, .weight_sd_m = 3.0};
  EXPECT_NEAR(path_weight({4.0, 1.65, 15.0}, {}, path, kRoad, wide), std::exp(-0.5 * std::pow(4.0 / 3.0, 2)), 1e-12);
}

}  // namespace
}  // namespace groundscale
