#include "groundscale/road/road_matcher.hpp"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "groundscale/road/region.hpp"
#include "groundscale/road/test_road_internal.hpp"

namespace groundscale {
namespace {

using namespace test_road;

class RoadMatching : public testing::TestWithParam<FrontEndKind> {
 protected:
  RoadTrackingOptions options() const { return {.front_end = GetParam()}; }
  RoadView first() const { return {.image = views.first}; }

  const Views views = render();
  const Image region = region_mask({Eigen::Vector3d::UnitZ(), 0.0}, kRoad, *camera(), {});
};

TEST_P(RoadMatching, ThroughTheRightWarpHasNoBias) {
  RoadMatcher matcher(options());
  RoadView view = first();
  matcher.fill(view, region);
  const Matches matches = matcher.match(view, views.second, {kMotion, kRoad}, true, *camera());
  ASSERT_GT(matches.size(), 100U);
  // As for track_on_road: a twentieth of a pixel of 15 is 0.3 % of the step.
  EXPECT_LT(bias_of(matches).cwiseAbs().maxCoeff(), 0.05);
}

TEST_P(RoadMatching, ThroughAWarpThatIsATenthOffIsNearlyAsGood) {
  for (const double factor : {0.9, 1.1}) {
    RoadMatcher matcher(options());
    RoadView view = first();
    matcher.fill(view, region);
    const RoadWarp wrong{{kMotion.rotation, factor * kMotion.translation}, kRoad};
    const Matches some = matcher.match_roughly(view, views.second, wrong, *camera());
    const Matches all = matcher.match(view, views.second, wrong, false, *camera());
    ASSERT_GT(some.size(), 50U);
    ASSERT_GE(all.size(), some.size());
    EXPECT_LT(bias_of(some).cwiseAbs().maxCoeff(), 0.1) << factor;
    EXPECT_LT(bias_of(all).cwiseAbs().maxCoeff(), 0.1) << factor;
  }
}

TEST_P(RoadMatching, NewPointsLieInTheRegionAndMatchesAreNoMoreThanWanted) {
  RoadTrackingOptions few = options();
  few.max_points = 40;
  RoadMatcher matcher(few);
  RoadView view = first();
  matcher.fill(view, region);
  ASSERT_FALSE(view.points.empty());
  for (const TrackPoint& point : view.points) EXPECT_TRUE(wanted_by(region, point.pixel)) << point.pixel.transpose();
  const Matches matches = matcher.match(view, views.second, {kMotion, kRoad}, true, *camera());
  EXPECT_GT(matches.size(), 10U);
  EXPECT_LE(matches.size(), 40U);
}

TEST_P(RoadMatching, PointsThatCameFromBeforeStayUnderTheirIds) {
  RoadMatcher matcher(options());
  RoadView view = first();
  matcher.fill(view, region);
  const Matches before = matcher.match(view, views.second, {kMotion, kRoad}, true, *camera());
  RoadView next{.image = views.second};
  for (const Match& match : before) next.points.push_back({match.id, match.pixel2});
  matcher.fill(next, region);
  ASSERT_GT(next.points.size(), 50U);
  EXPECT_TRUE(std::is_sorted(next.points.begin(), next.points.end(),
                             [](const TrackPoint& a, const TrackPoint& b) { return a.id < b.id; }));
  // Back to the first image, where each is known to have been.
  const GroundPlane road = kRoad.seen_from(kMotion);
  const Matches back = matcher.match(next, views.first, {kMotion.inverse(), road}, true, *camera());
  std::size_t old = 0;
  std::size_t elsewhere = 0;
  for (const Match& match : back) {
    const auto same = std::find_if(before.begin(), before.end(), [&](const Match& m) { return m.id == match.id; });
    if (same == before.end()) continue;
    ++old;
    EXPECT_EQ(match.pixel1, same->pixel2);
    if ((match.pixel2 - same->pixel1).norm() > 0.5) ++elsewhere;
  }
  EXPECT_GT(old, 40U);
  EXPECT_LT(elsewhere, old / 10);  // least squares on weak texture
}

TEST_P(RoadMatching, WithoutARegionOrAnythingToSeeThereIsNothing) {
  RoadMatcher matcher(options());
  RoadView view = first();
  matcher.fill(view, region);
  EXPECT_TRUE(matcher.match(view, Image(480, 240), {kMotion, kRoad}, true, *camera()).empty());
  matcher.fill(view, {});
  EXPECT_TRUE(view.points.empty());
  EXPECT_TRUE(matcher.match(view, views.second, {kMotion, kRoad}, true, *camera()).empty());
  RoadView black{.image = Image(480, 240)};
  matcher.fill(black, region);
  EXPECT_TRUE(black.points.empty());
  matcher.fill(black, Image(480, 240));
  EXPECT_TRUE(black.points.empty());
}

INSTANTIATE_TEST_SUITE_P(FrontEnds, RoadMatching, testing::Values(FrontEndKind::kKlt, FrontEndKind::kStereoScan),
                         [](const auto& kind) {
                           return std::string(names_of<FrontEndKind>()[static_cast<std::size_t>(kind.param)]);
                         });

}  // namespace
}  // namespace groundscale
