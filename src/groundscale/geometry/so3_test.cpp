#include "groundscale/geometry/so3.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace groundscale {
namespace {

const Eigen::Vector3d kAxis = Eigen::Vector3d(1.0, -2.0, 0.5).normalized();

/// Brute force: sum of [w]^k / k!.
Eigen::Matrix3d exponential_series(const Eigen::Vector3d& w) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d term = Eigen::Matrix3d::Identity();
  for (int k = 1; k < 60; ++k) {
    term = term * skew(w) / k;
    sum += term;
  }
  return sum;
}

TEST(So3, SkewIsTheCrossProductsMatrix) {
  const Eigen::Vector3d a(1.0, 2.0, 3.0);
  // (1, 2, 3) x (-4, 0.5, 2) = (2 2 - 3 0.5, 3 (-4) - 1 2, 1 0.5 - 2 (-4))
  EXPECT_EQ(skew(a) * Eigen::Vector3d(-4.0, 0.5, 2.0), Eigen::Vector3d(2.5, -14.0, 8.5));
  EXPECT_EQ(skew(a), -skew(a).transpose());
}

class RotationBy : public testing::TestWithParam<double> {
 protected:
  const Eigen::Vector3d w_ = GetParam() * kAxis;
};

TEST_P(RotationBy, ExpIsTheExponentialSeries) {
  // Terms of the series are at most pi^3 / 6 in size, so it is right to about 1e-15 itself.
  EXPECT_LT((exp_so3(w_) - exponential_series(w_)).norm(), 1e-14);
}

TEST_P(RotationBy, LogUndoesExp) {
  // At most pi: an angle is known to rounding, also near 0 and near pi.
  EXPECT_LT((log_so3(exp_so3(w_)) - w_).norm(), 1e-14 + 1e-14 * GetParam());
}

TEST_P(RotationBy, AngleIsTheLengthOfTheVector) {
  // Relative near 0. Near pi both parts of the arc tangent come from entries of size 1.
  EXPECT_NEAR(rotation_angle(exp_so3(w_)), GetParam(), GetParam() < 1.0 ? 1e-15 + 1e-8 * GetParam() : 1e-14);
}

INSTANTIATE_TEST_SUITE_P(Angles, RotationBy,
                         testing::Values(0.0, 1e-15, 1e-9, 0.99e-8, 1.01e-8, 1e-4, 0.3, 1.5, 3.0,
                                         std::numbers::pi - 1e-6));

TEST(So3, LogOfHalfATurnHasLengthPiAlongTheAxis) {
  const Eigen::Vector3d w = log_so3(exp_so3(std::numbers::pi * kAxis));
  EXPECT_NEAR(w.norm(), std::numbers::pi, 1e-14);
  EXPECT_NEAR(std::abs(w.normalized().dot(kAxis)), 1.0, 1e-14);  // either sense is the same rotation
}

TEST(So3, LogIsTheShortWayRound) {
  const Eigen::Vector3d w = log_so3(exp_so3((2.0 * std::numbers::pi - 0.5) * kAxis));
  EXPECT_LT((w + 0.5 * kAxis).norm(), 1e-14);
}

TEST(So3, NearestRotationIsTheOneOfThePolarDecomposition) {
  Eigen::Matrix3d disturbed = exp_so3(0.7 * kAxis);
  disturbed += (Eigen::Matrix3d() << 0.05, -0.02, 0.01, 0.03, -0.04, 0.02, -0.01, 0.06, 0.02).finished();
  const Eigen::Matrix3d rotation = nearest_rotation(disturbed);
  EXPECT_LT((rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  // M = R P with P symmetric and positive is what makes R the nearest; P is near the identity here, so it is positive.
  const Eigen::Matrix3d stretch = rotation.transpose() * disturbed;
  EXPECT_LT((stretch - stretch.transpose()).norm(), 1e-14);
  EXPECT_LT((stretch - Eigen::Matrix3d::Identity()).norm(), 0.2);
}

TEST(So3, NearestRotationOfARotationIsItself) {
  const Eigen::Matrix3d rotation = exp_so3(2.0 * kAxis);
  EXPECT_LT((nearest_rotation(rotation) - rotation).norm(), 1e-15);
  EXPECT_LT((nearest_rotation(5.0 * rotation) - rotation).norm(), 1e-15);
}

}  // namespace
}  // namespace groundscale
