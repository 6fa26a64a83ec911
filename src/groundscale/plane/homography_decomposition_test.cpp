#include "groundscale/plane/homography_decomposition.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "groundscale/core/rng.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

Eigen::Vector3d random_vector(Rng& rng) { return {rng.normal(), rng.normal(), rng.normal()}; }

/// A motion over a road: forwards, mostly, with the camera turned a little.
HomographyDecomposition random_truth(Rng& rng) {
  HomographyDecomposition truth;
  truth.rotation = exp_so3(0.05 * random_vector(rng));
  truth.translation = rng.uniform(0.05, 1.0) * (Eigen::Vector3d(0, 0, -1) + 0.1 * random_vector(rng)).normalized();
  truth.normal = (Eigen::Vector3d(0, 1, 0) + 0.1 * random_vector(rng)).normalized();
  return truth;
}

Eigen::Matrix3d homography_of(const HomographyDecomposition& parts) {
  return parts.rotation + parts.translation * parts.normal.transpose();
}

double difference(const HomographyDecomposition& a, const HomographyDecomposition& b) {
  return (a.rotation - b.rotation).norm() + (a.translation - b.translation).norm() + (a.normal - b.normal).norm();
}

double nearest(const std::vector<HomographyDecomposition>& solutions, const HomographyDecomposition& wanted) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& solution : solutions) least = std::min(least, difference(solution, wanted));
  return least;
}

using Decompose = Result<std::vector<HomographyDecomposition>> (*)(const Eigen::Matrix3d&);

class Decomposition : public testing::TestWithParam<Decompose> {};

TEST_P(Decomposition, FindsTheMotionAndPlaneItWasMadeOfWhateverTheScale) {
  Rng rng(1);
  for (int k = 0; k < 200; ++k) {
    const HomographyDecomposition truth = random_truth(rng);
    const auto solutions = GetParam()(rng.uniform(0.1, 10.0) * homography_of(truth));
    ASSERT_TRUE(solutions);
    // Rounding of 1e-16, enlarged by squares of motions of 0.05 and up.
    EXPECT_LT(nearest(*solutions, truth), 1e-10);
  }
}

TEST_P(Decomposition, EverySolutionIsARotationAndAPlaneWithThatHomography) {
  Rng rng(2);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Matrix3d homography = homography_of(random_truth(rng));
    const auto solutions = GetParam()(homography);
    ASSERT_TRUE(solutions);
    ASSERT_EQ(solutions->size(), 4U);
    for (const auto& solution : *solutions) {
      EXPECT_LT((homography_of(solution) - homography).norm(), 1e-12);
      EXPECT_LT((solution.rotation.transpose() * solution.rotation - Eigen::Matrix3d::Identity()).norm(), 1e-10);
      EXPECT_GT(solution.rotation.determinant(), 0.0);
      EXPECT_NEAR(solution.normal.norm(), 1.0, 1e-12);
    }
  }
}

TEST_P(Decomposition, ALevelCameraThatDrivesStraightOnIsExactToo) {
  // Two of the three minors are 0 here: their square roots would be wrong by 1e-8.
  const HomographyDecomposition truth{Eigen::Matrix3d::Identity(), {0, 0, -0.6}, {0, 1, 0}};
  const auto solutions = GetParam()(homography_of(truth));
  ASSERT_TRUE(solutions);
  EXPECT_LT(nearest(*solutions, truth), 1e-13);
}

TEST_P(Decomposition, TowardsThePlaneTheTwoSolutionsAreOne) {
  const HomographyDecomposition truth{
      exp_so3({0.1, 0.0, 0.05}), exp_so3({0.1, 0.0, 0.05}) * Eigen::Vector3d(0, 0, -0.3), {0, 0, 1}};
  const auto solutions = GetParam()(homography_of(truth));
  ASSERT_TRUE(solutions);
  EXPECT_LT(nearest(*solutions, truth), 1e-7);  // a double root: sqrt of rounding
}

TEST_P(Decomposition, RefusesARotationAReflectionAndNumbersThatAreNone) {
  EXPECT_EQ(GetParam()(exp_so3({0.1, 0.2, 0.3})).error().code, ErrorCode::kDegenerateMotion);
  EXPECT_EQ(GetParam()(-Eigen::Matrix3d::Identity()).error().code, ErrorCode::kNotGround);
  EXPECT_EQ(GetParam()(Eigen::Matrix3d::Constant(std::nan(""))).error().code, ErrorCode::kNotGround);
}

INSTANTIATE_TEST_SUITE_P(AnalyticAndNumeric, Decomposition,
                         testing::Values(&decompose_homography, &decompose_homography_numerically));

TEST(HomographyDecomposition, SamePointsThroughOpenCvGiveTheSameSolutions) {
  Rng rng(3);
  for (int k = 0; k < 50; ++k) {
    const HomographyDecomposition truth = random_truth(rng);
    std::vector<cv::Point2d> from;
    std::vector<cv::Point2d> to;
    for (int i = 0; i < 40; ++i) {
      const Eigen::Vector3d ray(rng.uniform(-0.3, 0.3), rng.uniform(0.08, 0.25), 1.0);
      const Eigen::Vector3d moved = homography_of(truth) * ray;
      from.emplace_back(ray.x(), ray.y());
      to.emplace_back(moved.x() / moved.z(), moved.y() / moved.z());
    }
    const cv::Mat found = cv::findHomography(from, to, 0);
    ASSERT_FALSE(found.empty());
    std::vector<cv::Mat> rotations;
    std::vector<cv::Mat> translations;
    std::vector<cv::Mat> normals;
    const int count = cv::decomposeHomographyMat(found, cv::Mat::eye(3, 3, CV_64F), rotations, translations, normals);
    ASSERT_EQ(count, 4);
    Eigen::Matrix3d homography;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) homography(row, column) = found.at<double>(row, column);
    }
    const auto solutions = decompose_homography(homography);
    ASSERT_TRUE(solutions);
    for (std::size_t i = 0; i < 4; ++i) {
      HomographyDecomposition theirs;
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) theirs.rotation(row, column) = rotations[i].at<double>(row, column);
        theirs.translation(row) = translations[i].at<double>(row);
        theirs.normal(row) = normals[i].at<double>(row);
      }
      // OpenCV takes square roots of minors, which turn rounding of 1e-15 into 1e-7.
      EXPECT_LT(nearest(*solutions, theirs), 1e-5);
    }
    EXPECT_LT(nearest(*solutions, truth), 1e-5);
  }
}

}  // namespace
}  // namespace groundscale
