#include "groundscale/mapping/resection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/mapping/p3p_internal.hpp"
#include "groundscale/mapping/test_street_internal.hpp"

namespace groundscale {
namespace {

using testing::HasSubstr;

const RigidTransform kPose{exp_so3({0.03, -0.4, 0.02}), {3.0, -1.0, 12.0}};

/// Points in front of the camera at kPose, with noise and a share of sights that are anywhere in the image.
std::vector<PointSight> sights_of(const Camera& camera, double noise_px, double wrong_share, Rng& rng,
                                  int count = 200) {
  std::vector<PointSight> sights;
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d point = street_point(camera, rng);
    Eigen::Vector2d pixel = *camera.project(point) + noise_px * normal2(rng);
    if (rng.uniform() < wrong_share) pixel = {rng.uniform() * camera.width(), rng.uniform() * camera.height()};
    sights.push_back({kPose.inverse() * point, pixel});
  }
  return sights;
}

/// A pose whose pixels are off by about that much: half by a turn, half by a shift at 15 m.
RigidTransform guess_off_by(double px, const Camera& camera, Rng& rng) {
  const double angle = px / camera.focal_px() / std::sqrt(2.0);
  return {exp_so3(angle * normal3(rng).normalized()) * kPose.rotation,
          kPose.translation + 15.0 * angle * normal3(rng).normalized()};
}

/// (w, u) with kPose = (exp(w) R, t + u).
Eigen::Matrix<double, 6, 1> error_of(const RigidTransform& pose) {
  Eigen::Matrix<double, 6, 1> error;
  error << log_so3(kPose.rotation * pose.rotation.transpose()), kPose.translation - pose.translation;
  return error;
}

TEST(ThreePointPoses, OneOfThemIsTheTruth) {
  Rng rng(1);
  const CameraPtr camera = test_camera(TestCamera::kPinhole);
  for (int trial = 0; trial < 20; ++trial) {
    const auto sights = sights_of(*camera, 0.0, 0.0, rng, 3);
    double best = std::numeric_limits<double>::infinity();
    const std::array points{sights[0].point_in_world, sights[1].point_in_world, sights[2].point_in_world};
    const std::array rays{*camera->ray(sights[0].pixel), *camera->ray(sights[1].pixel), *camera->ray(sights[2].pixel)};
    for (const RigidTransform& pose : three_point_poses(points, rays)) best = std::min(best, error_of(pose).norm());
    EXPECT_LT(best, 1e-4);  // the quartic loses half of the digits
  }
}

class ResectionOf : public testing::TestWithParam<TestCamera> {
 protected:
  const CameraPtr camera_ = test_camera(GetParam());
};

TEST_P(ResectionOf, IsExactWithoutNoise) {
  Rng rng(2);
  const auto sights = sights_of(*camera_, 0.0, 0.0, rng);
  const auto refined = refine_pose(sights, *camera_, guess_off_by(10.0, *camera_, rng), {});
  ASSERT_TRUE(refined) << refined.error().message;
  EXPECT_LT(error_of(refined->cam_from_world).norm(), 1e-9);
  EXPECT_EQ(refined->inliers.size(), sights.size());
  const auto found = resect(sights, *camera_, {}, rng);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_LT(error_of(found->cam_from_world).norm(), 1e-9);
}

TEST_P(ResectionOf, ItsCovarianceIsThatOfItsErrors) {
  Rng rng(3);
  double squares = 0.0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto sights = sights_of(*camera_, 0.3, 0.0, rng, 100);
    const auto refined = refine_pose(sights, *camera_, guess_off_by(5.0, *camera_, rng), {});
    ASSERT_TRUE(refined);
    const Eigen::Matrix<double, 6, 1> error = error_of(refined->cam_from_world);
    squares += error.dot(refined->covariance.inverse() * error);
  }
  // Chi-square of 6 degrees of freedom has variance 12, four sd of the mean. Cauchy's weights (0.87 on average at
  // 0.3 px) make the covariance larger by their inverse, so the squares are smaller by up to that.
  const double tolerance = 4.0 * std::sqrt(12.0 / kTrials);
  EXPECT_LT(squares / kTrials, 6.0 + tolerance);
  EXPECT_GT(squares / kTrials, 0.8 * 6.0 - tolerance);
}

TEST_P(ResectionOf, APredictionOffByTenPixelsConvergesBesideThirtyPercentWrongSights) {
  Rng rng(4);
  for (int trial = 0; trial < 100; ++trial) {
    const auto sights = sights_of(*camera_, 0.3, 0.3, rng);
    const auto refined = refine_pose(sights, *camera_, guess_off_by(10.0, *camera_, rng), {});
    ASSERT_TRUE(refined) << refined.error().message;
    const Eigen::Matrix<double, 6, 1> error = error_of(refined->cam_from_world);
    // Chi-square of 6 beyond 40 has a probability of 5e-7.
    EXPECT_LT(error.dot(refined->covariance.inverse() * error), 40.0) << trial;
    EXPECT_GT(refined->inliers.size(), 110U);
  }
}

TEST_P(ResectionOf, AMinorityThatAgreesWithThePredictionDoesNotHoldItBack) {
  // Cars that drive along with the camera: they stand still where the prediction does.
  Rng rng(15);
  for (int trial = 0; trial < 20; ++trial) {
    auto sights = sights_of(*camera_, 0.3, 0.0, rng);
    const RigidTransform guess = guess_off_by(20.0, *camera_, rng);
    for (std::size_t k = 0; k < sights.size() * 3 / 10; ++k) {
      const auto pixel = camera_->project(guess * sights[k].point_in_world);
      if (pixel) sights[k].pixel = *pixel + 0.3 * normal2(rng);
    }
    const auto refined = refine_pose(sights, *camera_, guess, {});
    ASSERT_TRUE(refined) << refined.error().message;
    EXPECT_LT(error_of(refined->cam_from_world).tail<3>().norm(), 0.05) << trial;
  }
}

TEST_P(ResectionOf, NeedsNoPredictionWithThreePoints) {
  Rng rng(5);
  for (int trial = 0; trial < 20; ++trial) {
    const auto sights = sights_of(*camera_, 0.3, 0.4, rng);
    const auto found = resect(sights, *camera_, {}, rng);
    ASSERT_TRUE(found) << found.error().message;
    const Eigen::Matrix<double, 6, 1> error = error_of(found->cam_from_world);
    EXPECT_LT(error.dot(found->covariance.inverse() * error), 40.0) << trial;
    EXPECT_TRUE(std::is_sorted(found->inliers.begin(), found->inliers.end()));
  }
}
INSTANTIATE_TEST_SUITE_P(Cameras, ResectionOf,
                         testing::Values(TestCamera::kPinhole, TestCamera::kDistorted, TestCamera::kFisheye));

class ResectionNoise : public testing::TestWithParam<double> {};

TEST_P(ResectionNoise, ErrorStaysWithinItsBound) {
  Rng rng(6);
  const double noise_px = GetParam();
  const CameraPtr camera = test_camera(TestCamera::kPinhole);
  const auto refined = refine_pose(sights_of(*camera, noise_px, 0.1, rng), *camera, kPose, {});
  ASSERT_TRUE(refined);
  const Eigen::Matrix<double, 6, 1> error = error_of(refined->cam_from_world);
  // Stated bounds for 200 points between 6 and 45 m: 1 mrad and 1.5 cm a pixel of noise.
  EXPECT_LT(error.head<3>().norm(), 1e-3 * noise_px);
  EXPECT_LT(error.tail<3>().norm(), 1.5e-2 * noise_px);
  EXPECT_NEAR(refined->rms_px, std::sqrt(2.0) * noise_px, 0.15 * noise_px);
}
INSTANTIATE_TEST_SUITE_P(Pixels, ResectionNoise, testing::Values(0.1, 0.3, 0.6));

TEST(Resection, APointOfTwiceTheSdCountsAQuarterAndMayMissByTwice) {
  Rng rng(7);
  const CameraPtr camera = test_camera(TestCamera::kPinhole);
  auto sights = sights_of(*camera, 0.0, 0.0, rng);
  sights[0].pixel.x() += 4.0;
  sights[1].pixel.x() += 4.0;
  sights[1].sd_px = 2.0;
  const auto refined = refine_pose(sights, *camera, kPose, {});
  ASSERT_TRUE(refined);
  EXPECT_THAT(refined->inliers, testing::Not(testing::Contains(0)));
  EXPECT_THAT(refined->inliers, testing::Contains(1));
}

TEST(Resection, UniformSdsScaleNothingButTheThresholds) {
  Rng rng(8);
  const CameraPtr camera = test_camera(TestCamera::kPinhole);
  auto sights = sights_of(*camera, 0.3, 0.2, rng);
  const auto plain = refine_pose(sights, *camera, kPose, {});
  for (PointSight& sight : sights) sight.sd_px = 0.5;
  ResectionOptions twice;
  twice.loss_px *= 2.0;
  twice.max_error_px *= 2.0;
  const auto scaled = refine_pose(sights, *camera, kPose, twice);
  ASSERT_TRUE(plain && scaled);
  EXPECT_LT((error_of(plain->cam_from_world) - error_of(scaled->cam_from_world)).norm(), 1e-6);
  EXPECT_EQ(plain->inliers, scaled->inliers);
  EXPECT_LT((plain->covariance - scaled->covariance).norm(), 1e-4 * plain->covariance.norm());
}

TEST(Resection, TooFewPointsAreAnErrorWithTheirNumber) {
  Rng rng(9);
  const CameraPtr camera = test_camera(TestCamera::kPinhole);
  const auto few = sights_of(*camera, 0.3, 0.0, rng, 19);
  for (const auto& result : {refine_pose(few, *camera, kPose, {}), resect(few, *camera, {}, rng)}) {
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kTooFewMatches);
    EXPECT_THAT(result.error().message, HasSubstr("19"));
  }
  EXPECT_FALSE(refine_pose({}, *camera, kPose, {}));
  EXPECT_FALSE(resect({}, *camera, {}, rng));
}

TEST(Resection, NothingAgreesWhereAllSightsAreWrong) {
  Rng rng(10);
  const CameraPtr camera = test_camera(TestCamera::kPinhole);
  const auto wrong = sights_of(*camera, 0.3, 1.0, rng);
  for (const auto& result : {refine_pose(wrong, *camera, kPose, {}), resect(wrong, *camera, {}, rng)}) {
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kTooFewMatches);
  }
}

TEST(Resection, PointsBehindTheGuessAreAnError) {
  Rng rng(11);
  const CameraPtr camera = test_camera(TestCamera::kPinhole);
  const RigidTransform turned{exp_so3({0.0, 3.14, 0.0}) * kPose.rotation, -kPose.translation};
  const auto result = refine_pose(sights_of(*camera, 0.3, 0.0, rng), *camera, turned, {});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kTooFewMatches);
}

TEST(Resection, PointsOnOneLineDoNotFixAPose) {
  Rng rng(12);
  const CameraPtr camera = test_camera(TestCamera::kPinhole);
  std::vector<PointSight> sights;
  for (int k = 0; k < 50; ++k) {
    const Eigen::Vector3d point(1.0, 0.5 + 0.02 * k, 10.0 + 0.2 * k);
    sights.push_back({kPose.inverse() * point, *camera->project(point)});
  }
  const auto result = refine_pose(sights, *camera, kPose, {});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kNotConverged);
  EXPECT_FALSE(resect(sights, *camera, {}, rng));
}

TEST(Resection, TheSameInputGivesTheSameBytes) {
  Rng rng(13);
  const CameraPtr camera = test_camera(TestCamera::kPinhole);
  const auto sights = sights_of(*camera, 0.3, 0.3, rng);
  Rng first_rng(14);
  Rng second_rng(14);
  const auto first = resect(sights, *camera, {}, first_rng);
  const auto second = resect(sights, *camera, {}, second_rng);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->cam_from_world.rotation, second->cam_from_world.rotation);
  EXPECT_EQ(first->cam_from_world.translation, second->cam_from_world.translation);
  EXPECT_EQ(first->inliers, second->inliers);
  EXPECT_EQ(first->covariance, second->covariance);
}

TEST(Resection, DefaultsAreInTheirRanges) { EXPECT_TRUE(check_ranges(ResectionOptions{})); }

}  // namespace
}  // namespace groundscale
