#include "groundscale/motion/two_view.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "groundscale/geometry/essential.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/motion/five_point_internal.hpp"

namespace groundscale {
namespace {

constexpr double kFocalPx = 700.0;
const RigidTransform kForward{exp_so3({0.002, 0.02, -0.001}), Eigen::Vector3d(0.05, 0.01, -1.0).normalized()};

double degrees(double rad) { return rad * 180.0 / std::numbers::pi; }

/// Points of a street, seen before and after a motion, with noise in pixels and a share of wrong matches.
std::vector<RayPair> street(const RigidTransform& cam2_from_cam1, double noise_px, double wrong_share, Rng& rng,
                            int count = 300) {
  std::vector<RayPair> pairs;
  const auto noisy = [&](const Eigen::Vector3d& point) {
    const Eigen::Vector3d noise(rng.normal(), rng.normal(), 0.0);
    return Eigen::Vector3d((point / point.z() + noise * (noise_px / kFocalPx)).normalized());
  };
  for (int k = 0; k < count; ++k) {
    const double z = rng.uniform(8.0, 60.0);
    const Eigen::Vector3d point(rng.uniform(-0.8, 0.8) * z, rng.uniform(-0.25, 0.2) * z, z);
    Eigen::Vector3d seen = cam2_from_cam1 * point;
    if (rng.uniform() < wrong_share) seen += Eigen::Vector3d(rng.uniform(-3, 3), rng.uniform(-3, 3), 0.0);
    pairs.push_back({k, noisy(point), noisy(seen)});
  }
  return pairs;
}

TEST(FivePoint, OneOfTheEssentialMatricesIsThatOfTheMotion) {
  Rng rng(3);
  const auto pairs = street(kForward, 0.0, 0.0, rng, 5);
  const Eigen::Matrix3d truth = essential_matrix(kForward).normalized();
  double best = 1.0;
  for (const Eigen::Matrix3d& essential : five_point_essentials({pairs[0], pairs[1], pairs[2], pairs[3], pairs[4]})) {
    const Eigen::Matrix3d unit = essential.normalized();
    best = std::min({best, (unit - truth).norm(), (unit + truth).norm()});
  }
  EXPECT_LT(best, 1e-6);  // the solver's polynomial loses half of the digits
}

TEST(TwoViewMotion, IsExactWithoutNoise) {
  Rng rng(1);
  const TwoViewMotion motion = estimate_motion(street(kForward, 0.0, 0.0, rng), kFocalPx, {}, rng);
  ASSERT_EQ(motion.state, MotionState::kMoving) << motion.reason;
  EXPECT_LT((motion.cam2_from_cam1.rotation - kForward.rotation).norm(), 1e-7);
  EXPECT_LT((motion.cam2_from_cam1.translation - kForward.translation).norm(), 1e-6);
}

class MotionNoise : public testing::TestWithParam<double> {};

TEST_P(MotionNoise, ErrorStaysWithinFourOfItsStandardDeviations) {
  Rng rng(2);
  const double noise_px = GetParam();
  const auto pairs = street(kForward, noise_px, 0.2, rng);
  const TwoViewMotion motion = estimate_motion(pairs, kFocalPx, {}, rng);
  ASSERT_EQ(motion.state, MotionState::kMoving) << motion.reason;
  const double rotation_error = rotation_angle(motion.cam2_from_cam1.rotation * kForward.rotation.transpose());
  const double rotation_sd = std::sqrt(motion.covariance.topLeftCorner<3, 3>().trace());
  EXPECT_LT(rotation_error, 4.0 * rotation_sd);
  EXPECT_LT(degrees(rotation_sd), 0.3 * noise_px + 1e-3);
  const double direction_error = (motion.cam2_from_cam1.translation - kForward.translation).norm();
  EXPECT_LT(direction_error, 4.0 * std::sqrt(motion.covariance.bottomRightCorner<2, 2>().trace()));
}
INSTANTIATE_TEST_SUITE_P(Pixels, MotionNoise, testing::Values(0.05, 0.1, 0.2));

TEST(TwoViewMotion, StandingStillHasNoMotion) {
  Rng rng(4);
  const TwoViewMotion motion = estimate_motion(street({}, 0.02, 0.1, rng), kFocalPx, {}, rng);
  EXPECT_EQ(motion.state, MotionState::kStill);
  EXPECT_EQ(motion.cam2_from_cam1.translation.norm(), 0.0);
}

TEST(TwoViewMotion, PureRotationHasNoDirection) {
  Rng rng(5);
  const RigidTransform turn{exp_so3({0.0, 0.05, 0.0}), Eigen::Vector3d::Zero()};
  const TwoViewMotion motion = estimate_motion(street(turn, 0.05, 0.1, rng), kFocalPx, {}, rng);
  EXPECT_EQ(motion.state, MotionState::kRotating);
  EXPECT_EQ(motion.cam2_from_cam1.translation.norm(), 0.0);
  EXPECT_LT(rotation_angle(motion.cam2_from_cam1.rotation * turn.rotation.transpose()), 1e-4);
}

TEST(TwoViewMotion, DrivingBackwardsPointsBackwards) {
  Rng rng(6);
  const RigidTransform back{exp_so3({0.0, -0.01, 0.0}), Eigen::Vector3d(0.02, 0.0, 1.0).normalized()};
  const TwoViewMotion motion = estimate_motion(street(back, 0.1, 0.1, rng), kFocalPx, {}, rng);
  ASSERT_EQ(motion.state, MotionState::kMoving);
  EXPECT_GT(motion.cam2_from_cam1.translation.z(), 0.99);
}

TEST(TwoViewMotion, TooFewMatchesAreLostWithTheReason) {
  Rng rng(7);
  const TwoViewMotion motion = estimate_motion(street(kForward, 0.0, 0.0, rng, 10), kFocalPx, {}, rng);
  EXPECT_EQ(motion.state, MotionState::kLost);
  EXPECT_EQ(motion.reason, "10 matches, 30 needed");
}

TEST(TwoViewMotion, MatchesWithoutCommonMotionAreLost) {
  Rng rng(8);
  const TwoViewMotion motion = estimate_motion(street(kForward, 40.0, 0.0, rng), kFocalPx, {}, rng);
  EXPECT_EQ(motion.state, MotionState::kLost);
}

}  // namespace
}  // namespace groundscale
