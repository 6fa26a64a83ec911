#include "groundscale/odometry/pair_observations.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"

namespace groundscale {
namespace {

constexpr double kHeightM = 1.6;
const CameraPtr kCamera = *PinholeCamera::create({.fx = 500.0, .fy = 500.0, .cx = 320.0, .cy = 200.0}, 640, 400);

/// Pixel of a point of the level road, in metres.
Eigen::Vector2d on_road(double aside_m, double ahead_m) { return *kCamera->project({aside_m, kHeightM, ahead_m}); }

/// A step of 0.8 m straight ahead, four matches over the image of which the second and the last agree with it, and two
/// on the road: on the path and 1.4 m beside it.
struct Example {
  Pair pair;
  Matches road;
  ExpectedRoad expected;

  Example() {
    for (const TrackId id : {3, 5, 8, 9}) {
      const auto k = static_cast<double>(id);
      pair.matches.push_back({id, {100.0 + k, 50.0}, {90.0 + k, 40.0}});
    }
    // A ray of the first match isn't there: pairs of rays may be fewer than matches.
    for (const TrackId id : {5, 8, 9}) {
      pair.rays.emplace_back();
      pair.rays.back().id = id;
    }
    pair.motion.inliers = {0, 2};
    pair.motion.cam2_from_cam1.translation = -Eigen::Vector3d::UnitZ();
    pair.motion.covariance(1, 1) = 0.25;
    road = {{21, on_road(0.0, 8.0), on_road(0.0, 7.2)}, {22, on_road(1.4, 8.0), on_road(1.4, 7.2)}};
    expected.warp.cam2_from_cam1.translation = {0.0, 0.0, -0.8};
    expected.warp.road_in_cam1 = {Eigen::Vector3d::UnitY(), kHeightM};
  }
};

TEST(ObservePair, HasTheMotionAndTheSceneThatAgrees) {
  const Example e;
  const RoadObservations seen = observe_pair(e.pair, e.road, kCamera, e.expected, {});
  ASSERT_EQ(seen.cam_from_reference.size(), 2U);
  EXPECT_EQ(seen.cam_from_reference[1].translation, -Eigen::Vector3d::UnitZ());
  EXPECT_EQ(seen.motion_covariance(1, 1), 0.25);
  EXPECT_EQ(seen.driving_direction, Eigen::Vector3d::UnitZ());
  EXPECT_FALSE(seen.predicted_plane);  // what is known by now isn't what was predicted
  EXPECT_DOUBLE_EQ(plane_in_baselines(e.expected.warp).height, kHeightM / 0.8);
  ASSERT_EQ(seen.scene.size(), 2U);
  EXPECT_EQ(seen.scene[0].pixel_in_reference.x(), 105.0);
  EXPECT_EQ(seen.scene[1].pixel_in_view1.x(), 99.0);
}

TEST(ObservePair, PointsCountLessBesideThePathButAllAlikeInAFixedRegion) {
  const Example e;
  RegionOptions region;
  region.weight_sd_m = 0.7;
  const RoadObservations seen = observe_pair(e.pair, e.road, kCamera, e.expected, region);
  ASSERT_EQ(seen.points.size(), 2U);
  EXPECT_EQ(seen.points[1].id, 22);
  EXPECT_EQ(seen.points[1].sights[0].pixel, e.road[1].pixel2);
  EXPECT_NEAR(seen.points[0].weight, 1.0, 1e-9);
  EXPECT_NEAR(seen.points[1].weight, std::exp(-2.0), 1e-9);  // two sd aside
  region.polygon_px = {0, 200, 640, 200, 640, 400, 0, 400};
  EXPECT_EQ(observe_pair(e.pair, e.road, kCamera, e.expected, region).points[1].weight, 1.0);
}

}  // namespace
}  // namespace groundscale
