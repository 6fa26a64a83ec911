#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/plane/ground_points_internal.hpp"
#include "groundscale/plane/test_road_internal.hpp"

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

RoadObservations level_road(const TestRoadOptions& options, Rng& rng) {
  RoadObservations observations = test_road(test_camera(), options, rng);
  observations.expected_normal = kTestRoad.normal_in_cam;
  return observations;
}

TEST(ModeOfHeights, HasTheBestScoreOfAllAsCountedDirectly) {
  Rng rng(1);
  std::vector<double> heights;
  std::vector<double> weights;
  for (int i = 0; i < 300; ++i) {
    heights.push_back(i % 3 == 0 ? rng.uniform(0.5, 3.0) : 1.6 + 0.05 * rng.normal());
    weights.push_back(rng.uniform(0.2, 1.0));
  }
  constexpr double kSigma = 0.1;
  double best = 0.0;
  double best_score = 0.0;
  for (const double height : heights) {
    double score = 0.0;
    for (std::size_t j = 0; j < heights.size(); ++j) {
      score += weights[j] * std::exp(-std::pow(height - heights[j], 2) / (2.0 * kSigma * kSigma));
    }
    if (score > best_score) best = height;
    best_score = std::max(best_score, score);
  }
  EXPECT_EQ(mode_of_heights(heights, weights, kSigma).height, best);
}

TEST(ModeOfHeights, VarianceIsThatOfRepeatedDraws) {
  // Far wider than the noise, the kernel makes the mode the mean: variance s^2 / n. The best of discrete heights is
  // then the one next to the mean, which adds little.
  constexpr int kHeights = 400;
  constexpr double kNoise = 0.05;
  Rng rng(2);
  double squares = 0.0;
  double variances = 0.0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> heights;
    for (int i = 0; i < kHeights; ++i) heights.push_back(1.6 + kNoise * rng.normal());
    const HeightMode mode = mode_of_heights(heights, std::vector<double>(kHeights, 1.0), 0.15);
    squares += std::pow(mode.height - 1.6, 2);
    variances += mode.variance;
  }
  EXPECT_NEAR(variances / kTrials, kNoise * kNoise / kHeights, 0.2 * kNoise * kNoise / kHeights);
  EXPECT_NEAR(squares / variances, 1.0, 0.4);  // 200 squares are known to 10 %
}

TEST(FitPlane, CovarianceIsThatOfRepeatedDraws) {
  Rng rng(3);
  constexpr int kTrials = 200;
  Eigen::Matrix3d drawn = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d formal = Eigen::Matrix3d::Zero();
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<GroundPoint> points;
    for (int i = 0; i < 60; ++i) {
      const Eigen::Vector3d ray(rng.uniform(-0.3, 0.3), rng.uniform(0.1, 0.3), 1.0);
      const Eigen::Vector3d point = ray * kTestRoad.height / kTestRoad.normal_in_cam.dot(ray);
      points.push_back({point + 0.02 * rng.normal() * kTestRoad.normal_in_cam, Eigen::Vector2d::Zero(), 1.0});
    }
    const auto fit = fit_plane(points);
    ASSERT_TRUE(fit);
    const Eigen::Vector3d error = fit->plane.inverse_form() - kTestRoad.inverse_form();
    drawn += error * error.transpose() / kTrials;
    formal += covariance_of_m(fit->plane, fit->covariance) / kTrials;
  }
  EXPECT_LT((drawn - formal).norm(), 0.4 * formal.norm());  // 200 squares are known to 10 %, of 3 parameters
}

class TriangulationKernel : public testing::TestWithParam<HeightKernel> {};

TEST_P(TriangulationKernel, HousesBesideTheRoadDoNotTakeTheVote) {
  Rng rng(4);
  RoadObservations observations = level_road({.noise_px = 0.1, .scene_count = 400}, rng);
  observations.predicted_plane = kTestRoad;
  PlaneOptions options;
  options.triangulation = {.points = GroundPoints::kAll, .kernel = GetParam()};
  const auto measured = estimate_plane_triangulation(observations, options, rng);
  ASSERT_TRUE(measured) << measured.error().message;
  EXPECT_NEAR(measured->plane.height, kTestRoad.height, 0.02 * kTestRoad.height);
}
INSTANTIATE_TEST_SUITE_P(Kernels, TriangulationKernel,
                         testing::Values(HeightKernel::kMedianDistance, HeightKernel::kBaseline,
                                         HeightKernel::kCameraHeight));

TEST(Triangulation, AWrongPitchGoesIntoTheHeightWithTheLeverOfThePoints) {
  Rng rng(5);
  RoadObservations observations = level_road({.noise_px = 0.1}, rng);
  observations.expected_normal = exp_so3({-kDegree, 0.0, 0.0}) * kTestRoad.normal_in_cam;  // looks down less
  const auto measured = estimate_plane_triangulation(observations, {}, rng);
  ASSERT_TRUE(measured) << measured.error().message;
  const double error = measured->plane.height - kTestRoad.height;
  // A degree at 6 to 12 m.
  EXPECT_GT(std::abs(error), 6.0 * kDegree);
  EXPECT_LT(std::abs(error), 12.0 * kDegree);
  // The covariance is that for the normal as given: the vote's alone in the height, the prior's alone in the normal.
  const Eigen::Vector3d n = measured->plane.normal_in_cam;
  const double height_sd = std::sqrt(n.dot(measured->covariance_of_m * n)) * std::pow(measured->plane.height, 2);
  EXPECT_LT(height_sd, 0.2 * std::abs(error));
  const Eigen::Vector3d across = Eigen::Vector3d::UnitX().cross(n).normalized();
  const double pitch_sd = std::sqrt(across.dot(measured->covariance_of_m * across)) * measured->plane.height;
  EXPECT_NEAR(pitch_sd, kDegree * measured->rms_px / PlaneOptions{}.point_sd_px, 1e-9);
}

TEST(Triangulation, WithoutAnExpectedNormalItSaysWhatItNeeds) {
  Rng rng(6);
  RoadObservations observations = level_road({}, rng);
  observations.expected_normal.setZero();
  const auto refused = estimate_plane_triangulation(observations, {}, rng);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("normal from the mounting"));
}

TEST(TriangulationRansac, PlanesFarFromTheExpectedNormalAreNotTried) {
  Rng rng(7);
  // Three quarters of the points on a wall.
  RoadObservations observations = level_road({.count = 400}, rng);
  const GroundPlane wall{Eigen::Vector3d::UnitZ(), 12.0};
  for (std::size_t i = 0; i < 300; ++i) {
    RoadPoint& point = observations.points[i];
    const Eigen::Vector3d ray = *test_camera()->ray(point.pixel_in_reference);
    point.sights[0].pixel = *test_camera()->project(kTestMotion * (ray * wall.height / wall.normal_in_cam.dot(ray)));
  }
  const auto measured = estimate_plane_triangulation_ransac(observations, {}, rng);
  ASSERT_TRUE(measured) << measured.error().message;
  // Points of the wall where it meets the road are taken along.
  EXPECT_NEAR(measured->plane.height, kTestRoad.height, 0.03 * kTestRoad.height);
}

TEST(TriangulationRansac, TheDirectionOfMotionSteadiesThePitch) {
  // The road runs along the motion here, as it does for a vehicle on a plane.
  TestRoadOptions road{.noise_px = 0.5, .count = 60};
  const Eigen::Vector3d along =
      (Eigen::Vector3d(0.02, 0, 1) - Eigen::Vector3d(0.02, 0, 1).dot(kTestRoad.normal_in_cam) * kTestRoad.normal_in_cam)
          .normalized();
  road.motion.translation = -(road.motion.rotation * along);
  PlaneOptions free;
  free.max_epipolar_px = 3.0;
  free.max_error_px = 3.0;
  PlaneOptions fused = free;
  free.triangulation_ransac.vanishing_point_sd_deg = 0.0;
  double free_squares = 0.0;
  double fused_squares = 0.0;
  for (int seed = 0; seed < 20; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    const RoadObservations observations = level_road(road, rng);
    Rng rng_a(1);
    Rng rng_b(1);
    const auto without = estimate_plane_triangulation_ransac(observations, free, rng_a);
    const auto with = estimate_plane_triangulation_ransac(observations, fused, rng_b);
    ASSERT_TRUE(without && with);
    free_squares += std::pow(without->plane.height - kTestRoad.height, 2);
    fused_squares += std::pow(with->plane.height - kTestRoad.height, 2);
    EXPECT_LT(with->covariance_of_m.trace(), without->covariance_of_m.trace());
  }
  EXPECT_LT(fused_squares, 0.5 * free_squares);
}

}  // namespace
}  // namespace groundscale
