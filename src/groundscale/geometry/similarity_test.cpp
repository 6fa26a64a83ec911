#include "groundscale/geometry/similarity.hpp"

#include <cmath>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "groundscale/core/rng.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

using Points = std::vector<Eigen::Vector3d>;

const Similarity kTruth{2.5, exp_so3({0.4, -1.2, 0.3}), {10.0, -3.0, 5.0}};

Points random_points(int count, Rng& rng) {
  Points points;
  for (int k = 0; k < count; ++k) points.emplace_back(rng.normal(), rng.normal(), rng.normal());
  return points;
}

Points moved(const Points& points, const Similarity& similarity) {
  Points result;
  for (const Eigen::Vector3d& point : points) result.push_back(similarity * point);
  return result;
}

double squared_error(const Points& source, const Points& target, const Similarity& similarity) {
  double sum = 0.0;
  for (std::size_t k = 0; k < source.size(); ++k) sum += (target[k] - similarity * source[k]).squaredNorm();
  return sum;
}

// Coordinates of size 10, one SVD: rounding stays beneath 1e-13.
constexpr double kTolerance = 1e-12;

TEST(AlignPoints, IsExactForPointsThatWereMoved) {
  Rng rng(1);
  const Points source = random_points(20, rng);
  const auto found = align_points(source, moved(source, kTruth), true);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->scale, kTruth.scale, kTolerance);
  EXPECT_LT((found->rotation - kTruth.rotation).norm(), kTolerance);
  EXPECT_LT((found->translation - kTruth.translation).norm(), kTolerance);
}

TEST(AlignPoints, ThreePointsAreEnough) {
  const Points source = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 2.0, 1.0}};
  const auto found = align_points(source, moved(source, kTruth), true);
  ASSERT_TRUE(found);
  EXPECT_LT(squared_error(source, moved(source, kTruth), *found), kTolerance);
}

TEST(AlignPoints, NeverMirrors) {
  Rng rng(2);
  const Points source = random_points(20, rng);
  Points mirrored;
  for (const Eigen::Vector3d& point : source) mirrored.emplace_back(point.x(), point.y(), -point.z());
  const auto found = align_points(source, mirrored, true);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->rotation.determinant(), 1.0, kTolerance);
}

class AlignNoisyPoints : public testing::TestWithParam<bool> {};

TEST_P(AlignNoisyPoints, NoNeighbourHasASmallerError) {
  const bool with_scale = GetParam();
  Rng rng(3);
  const Points source = random_points(30, rng);
  Points target = moved(source, kTruth);
  for (Eigen::Vector3d& point : target) point += 0.3 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
  const auto found = align_points(source, target, with_scale);
  ASSERT_TRUE(found);
  if (!with_scale) {
    EXPECT_EQ(found->scale, 1.0);
  }
  const double least = squared_error(source, target, *found);
  for (int trial = 0; trial < 200; ++trial) {
    constexpr double kStep = 1e-3;
    Similarity other = *found;
    other.rotation = exp_so3(kStep * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal())) * other.rotation;
    other.translation += kStep * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
    if (with_scale) other.scale += kStep * rng.normal();
    EXPECT_GT(squared_error(source, target, other), least);
  }
}
INSTANTIATE_TEST_SUITE_P(Scale, AlignNoisyPoints, testing::Bool());

TEST(AlignPoints, TooFewOrAllOnOneSpotAreRefused) {
  const Points two = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
  const Points one_spot(7, Eigen::Vector3d(0.1, 0.2, 0.3));  // their mean isn't exactly the spot: rounding
  const Points origin(3, Eigen::Vector3d::Zero());
  for (const Points& points : {Points{}, two, one_spot, origin}) {
    const auto found = align_points(points, points, true);
    ASSERT_FALSE(found) << points.size();
    EXPECT_EQ(found.error().code, ErrorCode::kTooFewMatches);
  }
}

TEST(AlignPointsDeathTest, ListsOfDifferentLengthsEndTheProgram) {
  EXPECT_DEATH((void)align_points(Points(3), Points(4), true), "come in pairs");
}

}  // namespace
}  // namespace groundscale
