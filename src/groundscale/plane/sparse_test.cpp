#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "groundscale/geometry/so3.hpp"
#include "groundscale/plane/methods.hpp"
#include "groundscale/plane/motion_refine_internal.hpp"
#include "groundscale/plane/test_road_internal.hpp"
#include "groundscale/plane/transfer_internal.hpp"

namespace groundscale {
namespace {

RoadObservations road(const CameraPtr& camera, double noise_px, double wrong_share, Rng& rng, int count = 250) {
  return test_road(camera, {.noise_px = noise_px, .wrong_share = wrong_share, .count = count}, rng);
}

class SparseExact : public testing::TestWithParam<std::tuple<PlaneRefinement, double>> {};

TEST_P(SparseExact, WithoutNoiseThePlaneIsThatOfTheRoad) {
  const auto [refinement, k1] = GetParam();
  PlaneOptions options;
  options.refinement = refinement;
  Rng rng(1);
  const auto measured = estimate_plane_sparse(road(test_camera(k1), 0.0, 0.0, rng), options, rng);
  ASSERT_TRUE(measured) << measured.error().message;
  // The simplex ends where its corners agree within 1e-7 of their cost, not of their place.
  const double tolerance = refinement == PlaneRefinement::kNelderMead ? 1e-3 : 1e-8;
  EXPECT_NEAR(measured->plane.height, kTestRoad.height, tolerance);
  EXPECT_LT(tilt_deg(measured->plane), 50.0 * tolerance);
}
INSTANTIATE_TEST_SUITE_P(RefinementAndDistortion, SparseExact,
                         testing::Combine(testing::Values(PlaneRefinement::kLevenbergMarquardt,
                                                          PlaneRefinement::kNelderMead),
                                          testing::Values(0.0, 0.015, -0.1)));

class SparseNoise : public testing::TestWithParam<double> {};

TEST_P(SparseNoise, HeightErrorStaysWithinFourStandardDeviationsDespiteOutliers) {
  const double noise_px = GetParam();
  Rng rng(2);
  const auto measured = estimate_plane_sparse(road(test_camera(), noise_px, 0.2, rng), {}, rng);
  ASSERT_TRUE(measured) << measured.error().message;
  const Eigen::Vector3d m = kTestRoad.inverse_form();
  const Eigen::Vector3d direction = m.normalized();
  const double sd = std::sqrt(direction.dot(measured->covariance_of_m * direction));
  EXPECT_LT(std::abs(measured->plane.inverse_form().norm() - m.norm()), 4.0 * sd);
  EXPECT_LT(sd / m.norm(), 0.05 * noise_px + 1e-6);
}
INSTANTIATE_TEST_SUITE_P(Pixels, SparseNoise, testing::Values(0.05, 0.1, 0.2));

TEST(Sparse, MoreViewsGiveABetterPlane) {
  double two_views = 0.0;
  double four_views = 0.0;
  for (int seed = 0; seed < 20; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    RoadObservations observations = road(test_camera(), 0.15, 0.0, rng);
    const auto two = estimate_plane_sparse(observations, {}, rng);
    for (int view = 2; view < 4; ++view) {
      const RigidTransform pose{kTestMotion.rotation, 0.5 * view * kTestMotion.translation};
      observations.cam_from_reference.push_back(pose);
      for (RoadPoint& point : observations.points) {
        const Eigen::Vector3d ray = *test_camera()->ray(point.pixel_in_reference);
        const auto pixel = test_camera()->project(pose * (ray * kTestRoad.height / kTestRoad.normal_in_cam.dot(ray)));
        point.sights.push_back({view, *pixel + 0.15 * Eigen::Vector2d(rng.normal(), rng.normal())});
      }
    }
    const auto four = estimate_plane_sparse(observations, {}, rng);
    ASSERT_TRUE(two && four);
    two_views += std::pow(two->plane.height - kTestRoad.height, 2);
    four_views += std::pow(four->plane.height - kTestRoad.height, 2);
  }
  EXPECT_LT(four_views, 0.5 * two_views);  // 3 sights instead of 1, of which one has 1.5 times the baseline
}

TEST(Sparse, TheDrivingDirectionHelpsWhereNoiseHidesTheNormal) {
  PlaneOptions options;  // nothing is refused for its noise
  options.max_epipolar_px = options.max_error_px = 5.0;
  options.huber_px = 2.0;
  options.direction_prior_deg = 0.2;  // it is exact here
  double without = 0.0;
  double with = 0.0;
  for (int seed = 0; seed < 40; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    RoadObservations observations = road(test_camera(), 0.8, 0.0, rng, 60);
    Rng same = rng;
    const auto free = estimate_plane_sparse(observations, options, rng);
    observations.driving_direction = kTestRoad.normal_in_cam.cross(Eigen::Vector3d::UnitX()).normalized();
    const auto held = estimate_plane_sparse(observations, options, same);
    ASSERT_TRUE(free && held);
    without += std::pow(free->plane.height - kTestRoad.height, 2);
    with += std::pow(held->plane.height - kTestRoad.height, 2);
    EXPECT_LT(held->covariance_of_m.trace(), free->covariance_of_m.trace()) << seed;
  }
  EXPECT_LT(with, 0.6 * without) << with / without;
}

TEST(Sparse, RefusesTooFewPointsAndAViewWithoutBaseline) {
  Rng rng(3);
  RoadObservations few = road(test_camera(), 0.0, 0.0, rng, 20);
  const auto refused = estimate_plane_sparse(few, {}, rng);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kTooFewMatches);

  RoadObservations standing = road(test_camera(), 0.0, 0.0, rng);
  standing.cam_from_reference[1] = {};
  for (RoadPoint& point : standing.points) point.sights[0].pixel = point.pixel_in_reference;
  EXPECT_FALSE(estimate_plane_sparse(standing, {}, rng));
}

TEST(TransferError, DerivativesAgreeWithFiniteDifferences) {
  Rng rng(4);
  const CameraPtr cam = test_camera(0.02);
  const RoadObservations observations = road(cam, 1.0, 0.0, rng, 10);
  const Eigen::Vector3d m = kTestRoad.inverse_form() * 1.03;
  constexpr double kStep = 1e-6;
  for (const Transfer& transfer : transfers_of(observations)) {
    const auto error = transfer_error(*cam, kTestMotion, m, transfer);
    ASSERT_TRUE(error);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
      const auto plus = transfer_error(*cam, kTestMotion, m + step, transfer);
      const auto minus = transfer_error(*cam, kTestMotion, m - step, transfer);
      EXPECT_LT(((plus->forward - minus->forward) / (2.0 * kStep) - error->forward_by_m.col(k)).norm(), 1e-4);
      EXPECT_LT(((plus->backward - minus->backward) / (2.0 * kStep) - error->backward_by_m.col(k)).norm(), 1e-4);
    }
    const auto by_motion = forward_by_motion(*cam, kTestMotion, m, transfer);
    const auto back_by_motion = backward_by_motion(*cam, kTestMotion, m, transfer);
    ASSERT_TRUE(by_motion && back_by_motion);
    const Eigen::Matrix<double, 3, 2> tangents = tangents_of(kTestMotion.translation);
    for (int k = 0; k < 5; ++k) {
      const auto moved = [&](double step) {
        RigidTransform pose = kTestMotion;
        if (k < 3) pose.rotation = exp_so3(step * Eigen::Vector3d::Unit(k)) * pose.rotation;
        if (k >= 3) pose.translation += step * tangents.col(k - 3);
        return *transfer_error(*cam, pose, m, transfer);
      };
      const TransferError plus = moved(kStep);
      const TransferError minus = moved(-kStep);
      EXPECT_LT(((plus.forward - minus.forward) / (2.0 * kStep) - by_motion->col(k)).norm(), 1e-4);
      EXPECT_LT(((plus.backward - minus.backward) / (2.0 * kStep) - back_by_motion->col(k)).norm(), 1e-4);
    }
  }
}

TEST(Sparse, StartsFromThePredictedPlaneWhereItIsToldTo) {
  Rng rng(9);
  RoadObservations observations = test_road(test_camera(), {.noise_px = 0.1}, rng);
  PlaneOptions options;
  Rng rng_a(1);
  const auto plain = estimate_plane_sparse(observations, options, rng_a);
  options.start = PlaneStart::kPredicted;
  Rng rng_b(1);
  const auto without = estimate_plane_sparse(observations, options, rng_b);
  ASSERT_TRUE(plain && without);
  EXPECT_EQ(without->plane.height, plain->plane.height);
  observations.predicted_plane = {kTestRoad.normal_in_cam, 1.03 * kTestRoad.height};
  Rng rng_c(1);
  const auto near = estimate_plane_sparse(observations, options, rng_c);
  ASSERT_TRUE(near) << near.error().message;
  EXPECT_NEAR(near->plane.height / plain->plane.height, 1.0, 1e-3);  // the same minimum
  // From a plane that is quite another nothing is found nearby.
  observations.predicted_plane->height = 3.0 * kTestRoad.height;
  Rng rng_d(1);
  EXPECT_FALSE(estimate_plane_sparse(observations, options, rng_d));
}

}  // namespace
}  // namespace groundscale
