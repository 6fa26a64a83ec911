#include "groundscale/tracking/tracker.hpp"

#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "groundscale/tracking/test_texture_internal.hpp"

namespace groundscale {
namespace {

constexpr int kWidth = 200;
constexpr int kHeight = 140;
const Eigen::Vector2d kShift(3.3, -1.7);  // px a frame

Image frame(int k) {
  static const TestTexture texture(4);
  return texture.render(kWidth, kHeight,
                        [k](int x, int y) { return Eigen::Vector2d(Eigen::Vector2d(x, y) - k * kShift); });
}

class Tracking : public testing::TestWithParam<FrontEndKind> {};

TEST_P(Tracking, FollowsAShiftToATenthOfAPixelUnderLastingIds) {
  const TrackingOptions options{.front_end = GetParam()};
  Tracker tracker(options);
  std::map<TrackId, std::pair<int, Eigen::Vector2d>> starts;
  for (int k = 0; k < 5; ++k) {
    tracker.advance(frame(k), {});
    for (const TrackPoint& point : tracker.points()) {
      const auto [start, is_new] = starts.try_emplace(point.id, k, point.pixel);
      // A window of 15 px that reaches over the edge sees only a part of itself move: such points drift.
      constexpr double kEdgePx = 16.0;
      const Eigen::Vector2d to_end = Eigen::Vector2d(kWidth - 1, kHeight - 1) - point.pixel;
      if (point.pixel.cwiseMin(to_end).minCoeff() < kEdgePx) continue;
      const Eigen::Vector2d expected = start->second.second + (k - start->second.first) * kShift;
      EXPECT_LT((point.pixel - expected).norm(), 0.1) << "frame " << k << ", id " << point.id;
    }
    // Some 40 cells; the shift carries a few of their points over the edge.
    if (k > 0) {
      EXPECT_GT(tracker.followed(), 20);
    }
  }
  int from_first = 0;
  for (const TrackPoint& point : tracker.points()) from_first += starts.at(point.id).first == 0 ? 1 : 0;
  EXPECT_GT(from_first, 20);
}

TEST_P(Tracking, AnIdThatIsLostNeverComesAgain) {
  const TrackingOptions options{.front_end = GetParam()};
  Tracker tracker(options);
  std::set<TrackId> seen, last;
  bool any_lost = false;
  for (int k = 0; k < 8; ++k) {
    tracker.advance(frame(k), {});
    std::set<TrackId> present;
    TrackId before = -1;
    for (const TrackPoint& point : tracker.points()) {
      EXPECT_GT(point.id, before) << "ids ascend";
      before = point.id;
      present.insert(point.id);
      EXPECT_TRUE(last.contains(point.id) || !seen.contains(point.id)) << "frame " << k << ", id " << point.id;
    }
    for (const TrackId id : last) any_lost = any_lost || !present.contains(id);
    seen.insert(present.begin(), present.end());
    last = present;
  }
  EXPECT_TRUE(any_lost);
}

TEST_P(Tracking, RevivedPointsAreFollowedUnderTheirOldIds) {
  const TrackingOptions options{.front_end = GetParam()};
  Tracker tracker(options);
  tracker.advance(frame(0), {});
  const std::vector<TrackPoint> before = tracker.points();
  ASSERT_GT(before.size(), 20U);
  tracker.advance(Image(kWidth, kHeight), {});
  ASSERT_TRUE(tracker.points().empty());
  tracker.advance(frame(0), {});
  ASSERT_GT(tracker.points().front().id, before.back().id);
  const std::size_t others = tracker.points().size();
  tracker.revive(before);
  tracker.revive({{before.front().id, {1.0, 1.0}}});  // still followed: it stays where it is
  EXPECT_EQ(tracker.points().size(), others + before.size());
  EXPECT_EQ(tracker.points().front().pixel, before.front().pixel);
  tracker.advance(frame(0), {});
  EXPECT_EQ(match_by_id(before, tracker.points()).size(), before.size());
}

TEST_P(Tracking, KeepsNoPointWhereTheMaskForbidsIt) {
  const TrackingOptions options{.front_end = GetParam()};
  Image mask(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth / 2; ++x) mask.data()[y * kWidth + x] = 255;
  }
  Tracker tracker(options);
  for (int k = 0; k < 5; ++k) {
    tracker.advance(frame(k), mask);
    EXPECT_GT(tracker.points().size(), 10U);
    for (const TrackPoint& point : tracker.points()) EXPECT_LT(point.pixel.x(), kWidth / 2);
  }
}

TEST_P(Tracking, LosesAllTracksInABlackFrameAndStartsAnewAfterIt) {
  const TrackingOptions options{.front_end = GetParam()};
  Tracker tracker(options);
  tracker.advance(frame(0), {});
  const TrackId last_id = tracker.points().back().id;
  tracker.advance(Image(kWidth, kHeight), {});
  EXPECT_EQ(tracker.followed(), 0);
  EXPECT_TRUE(tracker.points().empty());
  tracker.advance(frame(1), {});
  EXPECT_EQ(tracker.followed(), 0);
  ASSERT_FALSE(tracker.points().empty());
  EXPECT_GT(tracker.points().front().id, last_id);
}

TEST_P(Tracking, HasNoMoreTracksThanItMay) {
  TrackingOptions options{.front_end = GetParam()};
  options.max_tracks = 12;
  Tracker tracker(options);
  tracker.advance(frame(0), {});
  EXPECT_EQ(tracker.points().size(), 12U);
}

TEST_P(Tracking, ACopyGoesOnByItself) {
  const TrackingOptions options{.front_end = GetParam()};
  Tracker tracker(options);
  tracker.advance(frame(0), {});
  Tracker copy = tracker;
  tracker.advance(Image(kWidth, kHeight), {});
  EXPECT_TRUE(tracker.points().empty());
  const std::vector<TrackPoint> before = copy.points();
  copy.advance(frame(1), {});
  EXPECT_GT(match_by_id(before, copy.points()).size(), 20U);
  tracker = copy;
  tracker.advance(frame(2), {});
  EXPECT_GT(match_by_id(before, tracker.points()).size(), 15U);
}

INSTANTIATE_TEST_SUITE_P(FrontEnds, Tracking, testing::Values(FrontEndKind::kKlt, FrontEndKind::kStereoScan),
                         [](const auto& kind) {
                           return std::string(names_of<FrontEndKind>()[static_cast<std::size_t>(kind.param)]);
                         });

}  // namespace
}  // namespace groundscale
