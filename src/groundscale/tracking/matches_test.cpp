#include "groundscale/tracking/matches.hpp"

#include <gtest/gtest.h>

namespace groundscale {
namespace {

TEST(MatchById, PairsPointsWithTheSameIdAndLeavesOutTheOthers) {
  const std::vector<TrackPoint> points1{{1, {1.0, 0.0}}, {4, {4.0, 0.0}}, {5, {5.0, 0.0}}, {9, {9.0, 0.0}}};
  const std::vector<TrackPoint> points2{{0, {0.0, 2.0}}, {4, {4.0, 2.0}}, {6, {6.0, 2.0}}, {9, {9.0, 2.0}}};
  const Matches matches = match_by_id(points1, points2);
  ASSERT_EQ(matches.size(), 2U);
  EXPECT_EQ(matches[0].id, 4);
  EXPECT_EQ(matches[0].pixel1, Eigen::Vector2d(4.0, 0.0));
  EXPECT_EQ(matches[0].pixel2, Eigen::Vector2d(4.0, 2.0));
  EXPECT_EQ(matches[1].id, 9);
}

TEST(MatchById, OfNothingIsNothing) {
  const std::vector<TrackPoint> points{{1, {1.0, 0.0}}};
  EXPECT_TRUE(match_by_id({}, points).empty());
  EXPECT_TRUE(match_by_id(points, {}).empty());
}

}  // namespace
}  // namespace groundscale
