#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/plane/methods.hpp"
#include "groundscale/plane/test_road_internal.hpp"

namespace groundscale {
namespace {

RoadObservations street(double noise_px, Rng& rng, int scene_count = 300) {
  RoadObservations observations = test_road(test_camera(), {.noise_px = noise_px, .scene_count = scene_count}, rng);
  observations.expected_normal = kTestRoad.normal_in_cam;
  observations.predicted_plane = kTestRoad;
  return observations;
}

class DelaunayNormals : public testing::TestWithParam<DelaunayNormal> {};

TEST_P(DelaunayNormals, FindsTheRoadBetweenHousesAndACarThatHidesPartOfIt) {
  PlaneOptions options;
  options.delaunay.normal = GetParam();
  Rng rng(1);
  RoadObservations observations = street(0.1, rng);
  // The back of a car 9 m ahead, 1.8 m wide.
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d point(rng.uniform(-0.9, 0.9), rng.uniform(0.2, 1.3), 9.0);
    observations.scene.push_back({*test_camera()->project(point), *test_camera()->project(kTestMotion * point)});
  }
  const auto measured = make_delaunay_method(options)(observations, rng);
  ASSERT_TRUE(measured) << measured.error().message;
  EXPECT_NEAR(measured->plane.height, kTestRoad.height, 0.02 * kTestRoad.height);
  EXPECT_LT(tilt_deg(measured->plane), 0.5);
}
INSTANTIATE_TEST_SUITE_P(Normals, DelaunayNormals, testing::Values(DelaunayNormal::kExpected, DelaunayNormal::kFitted));

TEST(Delaunay, AFrameOfOtherHeightIsOutvotedByThoseBeforeIt) {
  // A predicted plane that is 8 % too high from the third frame on, as where the vehicle brakes: the heights of frames
  // before, in units of what was predicted for them, say 1, this one's say 0.92.
  PlaneOptions options;
  options.delaunay.window = 3;
  const EstimatePlane with_memory = make_delaunay_method(options);
  Rng rng(2);
  const RoadObservations seen = street(0.05, rng);
  ASSERT_TRUE(with_memory(seen, rng));
  ASSERT_TRUE(with_memory(seen, rng));
  RoadObservations braking = seen;
  braking.predicted_plane->height *= 1.08;
  const auto measured = with_memory(braking, rng);
  ASSERT_TRUE(measured);
  EXPECT_NEAR(measured->plane.height, 1.08 * kTestRoad.height, 0.01);
  // After two more frames the window has forgotten.
  ASSERT_TRUE(with_memory(braking, rng));
  const auto later = with_memory(braking, rng);
  ASSERT_TRUE(later);
  EXPECT_NEAR(later->plane.height, kTestRoad.height, 0.01);
}

TEST(Delaunay, WithoutAPredictionThereIsNoMemory) {
  const EstimatePlane method = make_delaunay_method({});
  Rng rng(3);
  RoadObservations seen = street(0.05, rng);
  seen.predicted_plane.reset();
  ASSERT_TRUE(method(seen, rng));
  seen.cam_from_reference[1].translation *= 0.5;
  const auto measured = method(seen, rng);
  ASSERT_TRUE(measured);
  EXPECT_NEAR(measured->plane.height, 0.5 * kTestRoad.height, 0.01);
  // Nor does a frame that has one remember those that had none.
  const auto predicted = method(street(0.05, rng), rng);
  ASSERT_TRUE(predicted);
  EXPECT_NEAR(predicted->plane.height, kTestRoad.height, 0.01);
}

TEST(Delaunay, PointsAboveTheHorizonAreNotEnough) {
  Rng rng(4);
  RoadObservations sky = street(0.0, rng, 0);
  sky.points.clear();
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d point(rng.uniform(-10, 10), rng.uniform(-8, -2), rng.uniform(20, 40));
    sky.scene.push_back({*test_camera()->project(point), *test_camera()->project(kTestMotion * point)});
  }
  const auto refused = make_delaunay_method({})(sky, rng);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("0 points below the horizon"));
}

}  // namespace
}  // namespace groundscale
