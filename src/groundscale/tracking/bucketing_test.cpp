#include "groundscale/tracking/bucketing.hpp"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace groundscale {
namespace {

using testing::ElementsAre;

const std::vector<Eigen::Vector2d> kCandidates = {{1, 1}, {2, 2}, {3, 3}, {15, 4}, {16, 5}, {4, 15}};

TEST(PickEvenly, TakesTheFirstOfEachCellBeforeTheSecondOfAny) {
  EXPECT_THAT(pick_evenly(kCandidates, {}, 10, 6), ElementsAre(0, 3, 5, 1, 4, 2));
  EXPECT_THAT(pick_evenly(kCandidates, {}, 10, 4), ElementsAre(0, 3, 5, 1));
  EXPECT_THAT(pick_evenly(kCandidates, {}, 10, 100).size(), 6U);
}

TEST(PickEvenly, CountsWhatIsTakenAsChosenBefore) {
  EXPECT_THAT(pick_evenly(kCandidates, {{5, 5}, {6, 6}}, 10, 3), ElementsAre(3, 5, 4));
  EXPECT_THAT(pick_evenly(kCandidates, {{500, -70}}, 10, 2), ElementsAre(0, 3));
}

TEST(PickEvenly, SpreadsARoundThatIsTooLarge) {
  std::vector<Eigen::Vector2d> row;
  for (int x = 0; x < 100; ++x) row.emplace_back(10.0 * x + 5.0, -3.0);
  const auto chosen = pick_evenly(row, {}, 10, 4);
  EXPECT_THAT(chosen, ElementsAre(0, 25, 50, 75));
}

TEST(PickEvenly, OfNothingOrForNothingIsNothing) {
  EXPECT_TRUE(pick_evenly({}, {{1, 1}}, 10, 5).empty());
  EXPECT_TRUE(pick_evenly(kCandidates, {}, 10, 0).empty());
  EXPECT_TRUE(pick_evenly(kCandidates, {}, 10, -3).empty());
}

TEST(ThinOut, KeepsEveryNth) {
  const std::vector<Eigen::Vector2d> points = {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}};
  EXPECT_THAT(thin_out(points, 3), ElementsAre(points[0], points[2], points[4]));
  EXPECT_EQ(thin_out(points, 9).size(), 6U);
  EXPECT_TRUE(thin_out(points, -1).empty());
}

}  // namespace
}  // namespace groundscale
