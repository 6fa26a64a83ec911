#include "groundscale/estimation/ransac.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace groundscale {
namespace {

/// y = slope x + offset through points of the plane.
struct LineProblem {
  struct Model {
    double slope = 0.0;
    double offset = 0.0;
  };
  struct Point {
    double x = 0.0;
    double y = 0.0;
  };
  static constexpr int kSampleSize = 2;
  std::vector<Point> points;

  int count() const { return static_cast<int>(points.size()); }
  double max_error() const { return 0.1; }
  double error(const Model& line, int item) const {
    const Point& point = points[static_cast<std::size_t>(item)];
    return std::abs(point.y - (line.slope * point.x + line.offset));
  }
  std::vector<Model> fit(std::span<const int> sample) const {
    const Point& a = points[static_cast<std::size_t>(sample[0])];
    const Point& b = points[static_cast<std::size_t>(sample[1])];
    if (a.x == b.x) return {};
    const double slope = (b.y - a.y) / (b.x - a.x);
    return {{slope, a.y - slope * a.x}};
  }
};

/// 30 points on y = 2 x - 1 within 0.02, then as many anywhere.
LineProblem line_among_outliers() {
  Rng rng(3);
  LineProblem problem;
  for (int k = 0; k < 30; ++k) {
    const double x = rng.uniform(-5.0, 5.0);
    problem.points.push_back({x, 2.0 * x - 1.0 + rng.uniform(-0.02, 0.02)});
  }
  for (int k = 0; k < 30; ++k) {
    const double x = rng.uniform(-5.0, 5.0);
    const double away = rng.uniform(0.5, 8.0);
    problem.points.push_back({x, 2.0 * x - 1.0 + (k % 2 == 0 ? away : -away)});
  }
  return problem;
}

TEST(Ransac, FindsALineAmongOutliers) {
  const LineProblem problem = line_among_outliers();
  Rng rng(1);
  const auto found = ransac(problem, {.min_trials = 200, .max_trials = 300, .confidence = 0.999}, rng);
  ASSERT_TRUE(found);
  // Noise of 0.02 at both points of a sample; the best of many samples has them far apart.
  EXPECT_NEAR(found->model.slope, 2.0, 0.02);
  EXPECT_NEAR(found->model.offset, -1.0, 0.05);
  std::vector<int> expected(30);
  for (int k = 0; k < 30; ++k) expected[static_cast<std::size_t>(k)] = k;
  EXPECT_THAT(found->inliers, testing::ElementsAreArray(expected));
}

TEST(Ransac, IsTheSameForTheSameSeed) {
  const LineProblem problem = line_among_outliers();
  Rng first(7);
  Rng second(7);
  const auto a = ransac(problem, RansacOptions{}, first);
  const auto b = ransac(problem, RansacOptions{}, second);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->model.slope, b->model.slope);
  EXPECT_EQ(a->model.offset, b->model.offset);
  EXPECT_EQ(a->trials, b->trials);
  EXPECT_EQ(first.next(), second.next());
}

TEST(Ransac, WithFewerItemsThanASampleNeedsFindsNothing) {
  Rng rng(1);
  EXPECT_FALSE(ransac(LineProblem{}, RansacOptions{}, rng));
  EXPECT_FALSE(ransac(LineProblem{{{1.0, 1.0}}}, RansacOptions{}, rng));
}

TEST(Ransac, FindsNothingWhereNoSampleMakesAModel) {
  Rng rng(1);
  EXPECT_FALSE(ransac(LineProblem{{{1.0, 0.0}, {1.0, 1.0}, {1.0, 2.0}}}, RansacOptions{}, rng));
}

TEST(Ransac, StopsAtTheFewestTrialsWhereAllAreInliers) {
  LineProblem problem;
  for (int k = 0; k < 10; ++k) problem.points.push_back({1.0 * k, 3.0 * k});
  Rng rng(1);
  const auto found = ransac(problem, {.min_trials = 4, .max_trials = 300, .confidence = 0.999}, rng);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->trials, 4);
  EXPECT_EQ(found->inliers.size(), 10U);
}

TEST(Ransac, TakesAGuessThatNoSampleBeats) {
  const LineProblem problem{{{0.0, 0.05}, {0.0, -0.05}, {3.0, 0.05}, {3.0, -0.05}}};
  Rng rng(1);
  // y = 0 leaves 0.05 at every point; the line through any two of them leaves 0.1 at both others.
  const auto found = ransac(problem, RansacOptions{}, rng, {{0.0, 0.0}});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->model.slope, 0.0);
}

TEST(Ransac, CountsAnItemWithoutAnErrorAsAnOutlier) {
  LineProblem problem = line_among_outliers();
  problem.points.push_back({0.0, std::numeric_limits<double>::quiet_NaN()});
  Rng rng(1);
  const auto found = ransac(problem, {.min_trials = 200, .max_trials = 300, .confidence = 0.999}, rng);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->inliers.size(), 30U);
}

}  // namespace
}  // namespace groundscale
