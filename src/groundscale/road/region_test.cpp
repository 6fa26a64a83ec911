#include "groundscale/road/region.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "groundscale/camera/mounting.hpp"
#include "groundscale/camera/pinhole.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

const GroundPlane kLevelRoad{Eigen::Vector3d::UnitY(), 1.65};
const Mounting kTilted{0.05, 0.02, 0.03};
const GroundPlane kTiltedRoad{kTilted.normal_in_cam(), 1.4};

CameraPtr camera() { return *PinholeCamera::create({.fx = 400.0, .fy = 400.0, .cx = 320.0, .cy = 120.0}, 640, 240); }

TEST(PointOnPath, LiesOnTheCircleOfTheTurn) {
  // Right turn of radius 20 m about (20, ., 0); a quarter of it ends at (20, ., 20).
  const DrivenPath path{Eigen::Vector3d::UnitZ(), 1.0 / 20.0, 2.0};
  const double quarter = 0.5 * std::numbers::pi * 20.0;
  // Exact but for rounding, here and below.
  EXPECT_LT((point_on_path(path, kLevelRoad, quarter, 0.0) - Eigen::Vector3d(20.0, 1.65, 20.0)).norm(), 1e-12);
  // 3 m to its right, nearer to the centre.
  EXPECT_LT((point_on_path(path, kLevelRoad, quarter, 3.0) - Eigen::Vector3d(20.0, 1.65, 17.0)).norm(), 1e-12);
  const DrivenPath left{Eigen::Vector3d::UnitZ(), -1.0 / 20.0, 2.0};
  EXPECT_LT((point_on_path(left, kLevelRoad, quarter, 0.0) - Eigen::Vector3d(-20.0, 1.65, 20.0)).norm(), 1e-12);
  EXPECT_LT((point_on_path(left, kLevelRoad, quarter, 3.0) - Eigen::Vector3d(-20.0, 1.65, 23.0)).norm(), 1e-12);
}

TEST(PointOnPath, GoesStraightOnWhereTheTurnEnds) {
  const DrivenPath path{Eigen::Vector3d::UnitZ(), 1.0 / 20.0, 0.5 * std::numbers::pi};
  const double quarter = 0.5 * std::numbers::pi * 20.0;
  EXPECT_LT((point_on_path(path, kLevelRoad, quarter + 7.0, 0.0) - Eigen::Vector3d(27.0, 1.65, 20.0)).norm(), 1e-12);
}

TEST(PointOnPath, OfANearlyStraightPathIsThatOfAStraightOne) {
  const Eigen::Vector3d straight = point_on_path({Eigen::Vector3d::UnitZ(), 0.0}, kLevelRoad, 15.0, -2.0);
  EXPECT_LT((straight - Eigen::Vector3d(-2.0, 1.65, 15.0)).norm(), 1e-12);
  for (const double curvature : {1e-6, 1e-8, 1e-12, -1e-8}) {
    const DrivenPath path{Eigen::Vector3d::UnitZ(), curvature};
    // The parabola's 0.5 s^2 c is 1e-4 at most here.
    EXPECT_LT((point_on_path(path, kLevelRoad, 15.0, -2.0) - straight).norm(), 150.0 * std::abs(curvature) + 1e-12);
  }
}

TEST(OffsetFromPath, IsTheInverseOfPointOnPath) {
  const Eigen::Vector3d forward = kTilted.forward_in_cam();
  for (const double curvature : {0.0, 1e-9, 0.01, -0.01, 0.08, -0.08}) {
    const DrivenPath path{forward, curvature, 0.5};
    for (const double along : {2.0, 5.0, 12.0, 30.0}) {  // the tightest arc ends after 6.25 m
      for (const double aside : {-2.5, -0.3, 0.0, 1.8}) {
        const Eigen::Vector3d point = point_on_path(path, kTiltedRoad, along, aside);
        EXPECT_NEAR(kTiltedRoad.normal_in_cam.dot(point), kTiltedRoad.height, 1e-12);
        // Cancellation of 1 / curvature against a radius costs 1e-16 / 1e-9 of metres.
        EXPECT_NEAR(offset_from_path(path, kTiltedRoad, 0.3 * point), aside, 1e-5)
            << "curvature " << curvature << ", along " << along;
      }
    }
  }
}

TEST(RegionMask, IsTheTrapezeOfTheStrip) {
  RegionOptions options;
  options.half_width_m = 2.0;
  const Image mask = region_mask({Eigen::Vector3d::UnitZ(), 0.0}, kLevelRoad, *camera(), options);
  ASSERT_FALSE(mask.empty());
  // Each row is a distance z = f h / (v - cy), and the strip is 400 * 2 / z px to each side.
  for (int y = 0; y < mask.height(); y += 3) {
    const double z = y > 120 ? 400.0 * 1.65 / (y - 120) : 1e9;
    for (int x = 0; x < mask.width(); x += 3) {
      const double aside = std::abs(x - 320.0) * z / 400.0;
      // 2 px of slack about the edges, where rasterisation may round either way, and half a piece at the far end.
      const double slack = 2.0 * z / 400.0;
      const bool inside = z > 4.2 && z < 21.0 && aside < 2.0 - slack;
      const bool outside = z < 3.8 || z > 23.5 || aside > 2.0 + slack;
      EXPECT_TRUE(!inside || mask.at(x, y) == 255) << x << ", " << y;
      EXPECT_TRUE(!outside || mask.at(x, y) == 0) << x << ", " << y;
    }
  }
}

TEST(RegionMask, IsEmptyWhereTheCameraLooksUp) {
  const Mounting up{-0.6, 0.0, 0.0};
  const GroundPlane road{up.normal_in_cam(), 1.65};
  EXPECT_TRUE(region_mask({up.forward_in_cam(), 0.0}, road, *camera(), {}).empty());
}

TEST(RegionMask, BendsWithThePath) {
  const auto mean_x = [](double curvature) {
    const Image mask = region_mask({Eigen::Vector3d::UnitZ(), curvature}, kLevelRoad, *camera(), {});
    double sum = 0.0;
    int count = 0;
    constexpr int kRow = 120 + 66;  // 10 m ahead
    for (int x = 0; x < mask.width(); ++x) {
      if (mask.at(x, kRow) == 0) continue;
      sum += x;
      ++count;
    }
    return sum / count;
  };
  // An arc of radius 50 m is 1 m aside after 10 m: 40 px. Perspective of the strip's slanting edges moves it by less
  // than a quarter of that.
  EXPECT_NEAR(mean_x(0.02), 360.0, 10.0);
  EXPECT_NEAR(mean_x(-0.02), 280.0, 10.0);
}

TEST(RegionMask, WidensByWhereATurnMayGoOnTo) {
  DrivenPath path{Eigen::Vector3d::UnitZ(), 0.03};
  const auto width_px = [&path](int row) {
    const Image mask = region_mask(path, kLevelRoad, *camera(), {});
    int count = 0;
    for (int x = 0; x < mask.width(); ++x) count += mask.at(x, row) == 255 ? 1 : 0;
    return count;
  };
  constexpr int kNearRow = 120 + 110;  // 6 m ahead
  constexpr int kFarRow = 120 + 66;    // 10 m
  const int near_px = width_px(kNearRow);
  const int far_px = width_px(kFarRow);
  path.steady_m = 6.0;
  // To each side by 0.03 * 10^3 / 36 = 0.83 m, 33 px at 10 m; by 0.18 m, 12 px at 6 m.
  // A row cuts the bent strip at a slant, which adds up to a quarter.
  EXPECT_NEAR(width_px(kFarRow) - far_px, 67 * 1.12, 67 * 0.13);
  EXPECT_NEAR(width_px(kNearRow) - near_px, 24, 6);
  // No farther than to twice its width, 2.5 m to each side: 200 px more.
  path.steady_m = 0.1;
  EXPECT_NEAR(width_px(kFarRow) - far_px, 200, 15);
}

TEST(RegionMask, IsThePolygonWhereOneIsGiven) {
  RegionOptions options;
  options.polygon_px = {100, 50, 200, 50, 200, 150, 100, 150};
  const Image mask = region_mask({}, kLevelRoad, *camera(), options);
  ASSERT_FALSE(mask.empty());
  EXPECT_EQ(mask.at(101, 51), 255);
  EXPECT_EQ(mask.at(199, 149), 255);
  EXPECT_EQ(mask.at(98, 100), 0);
  EXPECT_EQ(mask.at(150, 152), 0);
  EXPECT_NEAR(mask_area(mask), 100 * 100, 2 * 4 * 100);  // a pixel about the edges either way
  options.polygon_px = {-200, 50, -100, 50, -100, 150};
  EXPECT_TRUE(region_mask({}, kLevelRoad, *camera(), options).empty());
}

TEST(Masks, MeetWhereBothAllow) {
  Image left(4, 2), right(4, 2);
  for (const int i : {0, 1, 2}) left.data()[i] = 255;
  for (const int i : {2, 3, 7}) right.data()[i] = 255;
  const Image both = intersect_masks(left, right);
  EXPECT_EQ(mask_area(both), 1);
  EXPECT_EQ(both.at(2, 0), 255);
  EXPECT_EQ(mask_area(intersect_masks({}, right)), 3);
  EXPECT_EQ(mask_area(intersect_masks(left, {})), 3);
  EXPECT_EQ(mask_area({}), 0);
}

/// Motion of a camera whose vehicle drives `arc_m` along a circle, worked out in the road's own axes (right, forward).
RigidTransform motion_on_circle(const Mounting& mounting, double radius_m, double arc_m) {
  const double turn = arc_m / radius_m;
  const Eigen::Vector3d centre2 = mounting.forward_in_cam() * (radius_m * std::sin(turn)) +
                                  mounting.right_in_cam() * (radius_m * (1.0 - std::cos(turn)));
  const Eigen::AngleAxisd cam1_from_cam2(turn, mounting.normal_in_cam());
  return RigidTransform{cam1_from_cam2.toRotationMatrix(), centre2}.inverse();
}

TEST(PathOfMotion, OfARightTurnHasPositiveCurvature) {
  for (const double radius : {25.0, -25.0, 400.0}) {
    const DrivenPath path =
        path_of_motion(motion_on_circle(kTilted, radius, 0.9), kTilted.normal_in_cam(), kTilted.forward_in_cam(), 20.0);
    // The chord is shorter than the arc by turn^2 / 24.
    EXPECT_NEAR(path.curvature_per_m, 1.0 / radius, 1e-4 / std::abs(radius));
    EXPECT_LT((path.forward_in_cam - kTilted.forward_in_cam()).norm(), 1e-9);
  }
}

TEST(PathOfMotion, InReverseStillPointsForwardsAlongTheSameCircle) {
  const DrivenPath path =
      path_of_motion(motion_on_circle(kTilted, 25.0, -0.9), kTilted.normal_in_cam(), kTilted.forward_in_cam(), 20.0);
  EXPECT_NEAR(path.curvature_per_m, 1.0 / 25.0, 1e-4 / 25.0);
  EXPECT_LT((path.forward_in_cam - kTilted.forward_in_cam()).norm(), 1e-9);
}

TEST(PathOfMotion, OfAStepTooShortOrFarFromAheadIsStraight) {
  const Eigen::Vector3d normal = kTilted.normal_in_cam();
  const DrivenPath still =
      path_of_motion({exp_so3(0.01 * normal), {0.0, 0.0, 0.001}}, normal, kTilted.forward_in_cam(), 20.0);
  EXPECT_EQ(still.curvature_per_m, 0.0);
  const DrivenPath sideways =
      path_of_motion({exp_so3(0.01 * normal), -1.0 * kTilted.right_in_cam()}, normal, kTilted.forward_in_cam(), 20.0);
  EXPECT_EQ(sideways.curvature_per_m, 0.0);
  EXPECT_LT((sideways.forward_in_cam - kTilted.forward_in_cam()).norm(), 1e-12);
}

}  // namespace
}  // namespace groundscale
