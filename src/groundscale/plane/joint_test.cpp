// `joint` and `decomposition`: methods that find a motion of their own.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/plane/methods.hpp"
#include "groundscale/plane/motion_refine_internal.hpp"
#include "groundscale/plane/test_road_internal.hpp"

namespace groundscale {
namespace {

double log_height_sd(const PlaneMeasurement& measured) {
  const Eigen::Vector3d n = measured.plane.normal_in_cam;
  return std::sqrt(n.dot(measured.covariance_of_m * n)) * measured.plane.height;
}

using Estimate = Result<PlaneMeasurement> (*)(const RoadObservations&, const PlaneOptions&, Rng&);

class OwnMotion : public testing::TestWithParam<Estimate> {};

TEST_P(OwnMotion, IsExactThoughTheGivenOneIsALittleOff) {
  Rng rng(1);
  RoadObservations observations = test_road(test_camera(), {}, rng);
  RigidTransform& given = observations.cam_from_reference[1];
  given.rotation = exp_so3({0.0003, -0.0002, 0.0001}) * given.rotation;
  given.translation = (given.translation + Eigen::Vector3d(0.002, -0.001, 0.0)).normalized();
  const auto measured = GetParam()(observations, {}, rng);
  ASSERT_TRUE(measured) << measured.error().message;
  ASSERT_TRUE(measured->motion);
  EXPECT_LT((measured->motion->rotation - kTestMotion.rotation).norm(), 1e-8);
  EXPECT_LT((measured->motion->translation - kTestMotion.translation).norm(), 1e-8);
  EXPECT_NEAR(measured->plane.height, kTestRoad.height, 1e-8);
  EXPECT_EQ(measured->inliers.size(), observations.points.size());
}

TEST_P(OwnMotion, EightUnknownsAreLessCertainThanThree) {
  Rng rng(2);
  const RoadObservations observations = test_road(test_camera(), {.noise_px = 0.2}, rng);
  const auto free = GetParam()(observations, {}, rng);
  const auto sparse = estimate_plane_sparse(observations, {}, rng);
  ASSERT_TRUE(free && sparse);
  EXPECT_GT(log_height_sd(*free), 1.2 * log_height_sd(*sparse));
}

TEST_P(OwnMotion, HeightErrorStaysWithinFourStandardDeviations) {
  for (const double noise_px : {0.05, 0.1, 0.2}) {
    for (int seed = 0; seed < 10; ++seed) {
      Rng rng(static_cast<std::uint64_t>(seed));
      const auto measured = GetParam()(test_road(test_camera(), {.noise_px = noise_px}, rng), {}, rng);
      ASSERT_TRUE(measured);
      EXPECT_LT(std::abs(std::log(measured->plane.height / kTestRoad.height)), 4.0 * log_height_sd(*measured));
      EXPECT_LT(log_height_sd(*measured), 0.2 * noise_px);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, OwnMotion, testing::Values(&estimate_plane_joint, &estimate_plane_decomposition));

TEST(Joint, MovesTheMotionOnlyAsFarAsItLowersTheCost) {
  Rng rng(3);
  const RoadObservations observations = test_road(test_camera(), {.noise_px = 0.3}, rng);
  const auto joint = estimate_plane_joint(observations, {}, rng);
  const auto sparse = estimate_plane_sparse(observations, {}, rng);
  ASSERT_TRUE(joint && sparse);
  EXPECT_LT(joint->rms_px, sparse->rms_px);
  EXPECT_GT((joint->motion->rotation - kTestMotion.rotation).norm(), 1e-6);
}

TEST(Decomposition, NumericAndAnalyticAgreeOnNoisyPoints) {
  Rng rng(4);
  const RoadObservations observations = test_road(test_camera(), {.noise_px = 0.3}, rng);
  PlaneOptions numeric;
  numeric.decomposition.solver = DecompositionSolver::kNumeric;
  Rng rng_a(5);
  Rng rng_b(5);
  const auto one = estimate_plane_decomposition(observations, {}, rng_a);
  const auto other = estimate_plane_decomposition(observations, numeric, rng_b);
  ASSERT_TRUE(one && other);
  EXPECT_NEAR(one->plane.height, other->plane.height, 1e-9);
  EXPECT_LT((one->plane.normal_in_cam - other->plane.normal_in_cam).norm(), 1e-9);
}

TEST(Decomposition, AHomographyOfAnotherMotionIsRefusedWithTheAngles) {
  Rng rng(6);
  RoadObservations observations = test_road(test_camera(), {}, rng);
  PlaneOptions options;
  options.max_epipolar_px = 20.0;
  options.decomposition.max_direction_deg = 0.01;
  observations.cam_from_reference[1].translation =
      (kTestMotion.translation + Eigen::Vector3d(0.01, 0.0, 0.0)).normalized();
  const auto refused = estimate_plane_decomposition(observations, options, rng);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kNotGround);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("0.6 deg in the direction of motion"));
}

}  // namespace
}  // namespace groundscale
