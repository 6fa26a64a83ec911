#include "groundscale/camera/mounting.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace groundscale {
namespace {

constexpr double kTolerance = 1e-15;  // unit vectors, a handful of products

TEST(Mounting, ALevelCameraHasTheRoadBelowTheWayAheadAndItsRightToTheRight) {
  const Mounting level;
  EXPECT_LT((level.normal_in_cam() - Eigen::Vector3d::UnitY()).norm(), kTolerance);
  EXPECT_LT((level.forward_in_cam() - Eigen::Vector3d::UnitZ()).norm(), kTolerance);
  EXPECT_LT((level.right_in_cam() - Eigen::Vector3d::UnitX()).norm(), kTolerance);
}

TEST(Mounting, LookingDownTheRoadAheadIsNearerAndTheWayLeadsUpInTheImage) {
  const Mounting down{.pitch_rad = 0.1};
  EXPECT_GT(down.normal_in_cam().z(), 0.0);   // the optical axis meets the road
  EXPECT_LT(down.forward_in_cam().y(), 0.0);  // the vanishing point lies above the middle
  // The camera turned by its pitch about its x axis sees what the level one sees turned the other way.
  const Eigen::AngleAxisd cam_from_level(0.1, Eigen::Vector3d::UnitX());
  EXPECT_LT((down.normal_in_cam() - cam_from_level * Eigen::Vector3d::UnitY()).norm(), kTolerance);
  EXPECT_LT((down.forward_in_cam() - cam_from_level * Eigen::Vector3d::UnitZ()).norm(), kTolerance);
}

TEST(Mounting, WithItsRightSideLowerTheRoadIsNearerOnTheRight) {
  const Mounting leaning{.roll_rad = 0.2};
  // Points 1 m ahead of the camera's plane, left and right: n . X is how far they lie down towards the road.
  EXPECT_GT(leaning.normal_in_cam().dot(Eigen::Vector3d(1.0, 0.0, 1.0)),
            leaning.normal_in_cam().dot(Eigen::Vector3d(-1.0, 0.0, 1.0)));
  EXPECT_LT((leaning.forward_in_cam() - Eigen::Vector3d::UnitZ()).norm(), kTolerance);
}

TEST(Mounting, LookingToTheRightTheWayLeadsToTheLeft) {
  const Mounting right{.yaw_rad = 0.3};
  EXPECT_LT((right.forward_in_cam() - Eigen::Vector3d(-std::sin(0.3), 0.0, std::cos(0.3))).norm(), kTolerance);
  EXPECT_LT((right.normal_in_cam() - Eigen::Vector3d::UnitY()).norm(), kTolerance);
}

class MountingAt : public testing::TestWithParam<Mounting> {};

TEST_P(MountingAt, TheWayLiesInTheRoadAndTheThreeDirectionsAreARightHandedFrame) {
  const Mounting& mounting = GetParam();
  Eigen::Matrix3d axes;  // right, down, forward, as the camera's own
  axes << mounting.right_in_cam(), mounting.normal_in_cam(), mounting.forward_in_cam();
  EXPECT_LT((axes.transpose() * axes - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_NEAR(axes.determinant(), 1.0, 1e-14);
}

TEST_P(MountingAt, TheWayIsThatOfTheLevelCameraTurnedByTheSmallestRotation) {
  const Mounting& mounting = GetParam();
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitY().cross(mounting.normal_in_cam());
  if (axis.norm() < 1e-6) return;  // level: every axis will do
  const Eigen::AngleAxisd tilt(std::atan2(axis.norm(), mounting.normal_in_cam().y()), axis.normalized());
  const Eigen::Vector3d level(-std::sin(mounting.yaw_rad), 0.0, std::cos(mounting.yaw_rad));
  EXPECT_LT((mounting.forward_in_cam() - tilt * level).norm(), 1e-14);
}

TEST_P(MountingAt, PlaneAnglesAreItsOwn) {
  const PlaneAngles angles = plane_angles(GetParam().normal_in_cam());
  // The arc sine near a roll of 90 degrees loses half of the digits; none of these comes near.
  EXPECT_NEAR(angles.pitch_rad, GetParam().pitch_rad, 1e-14);
  EXPECT_NEAR(angles.roll_rad, GetParam().roll_rad, 1e-14);
}

INSTANTIATE_TEST_SUITE_P(Angles, MountingAt,
                         testing::Values(Mounting{}, Mounting{0.1, 0.0, 0.0}, Mounting{-0.15, 0.05, 0.0},
                                         Mounting{0.02, -0.03, 0.2}, Mounting{0.6, 0.4, -1.2},
                                         Mounting{2.0, 0.5, 3.0}));

TEST(Mounting, UpsideDownTheWayIsStillAhead) {
  const Mounting upside_down{.roll_rad = std::numbers::pi};
  EXPECT_LT((upside_down.normal_in_cam() + Eigen::Vector3d::UnitY()).norm(), kTolerance);
  EXPECT_LT((upside_down.forward_in_cam() - Eigen::Vector3d::UnitZ()).norm(), kTolerance);
}

}  // namespace
}  // namespace groundscale
