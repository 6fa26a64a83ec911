#include "groundscale/road/road_tracker.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "groundscale/road/region.hpp"
#include "groundscale/road/test_road_internal.hpp"

namespace groundscale {
namespace {

using namespace test_road;

std::vector<TrackPoint> grid() {
  std::vector<TrackPoint> points;
  for (int y = 140; y <= 190; y += 10) {
    for (int x = 150; x <= 330; x += 12) points.push_back({static_cast<TrackId>(points.size()), {x, y}});
  }
  return points;
}

TEST(TrackOnRoad, ThroughTheRightWarpHasNoBias) {
  const Views views = render();
  const Matches matches =
      track_on_road(views.first, views.second, grid(), {kMotion, kRoad}, *camera(), RoadTrackingOptions{}.klt);
  ASSERT_GT(matches.size(), grid().size() * 8 / 10);
  // Interpolation of the table and of the image; a twentieth of a pixel of 15 is 0.3 % of the step.
  EXPECT_LT(bias_of(matches).cwiseAbs().maxCoeff(), 0.05);
}

TEST(TrackOnRoad, ThroughAWarpThatIsATenthOffIsNearlyAsGood) {
  const Views views = render();
  for (const double factor : {0.9, 1.1}) {
    const RoadWarp wrong{{kMotion.rotation, factor * kMotion.translation}, kRoad};
    const Matches matches =
        track_on_road(views.first, views.second, grid(), wrong, *camera(), RoadTrackingOptions{}.klt);
    ASSERT_GT(matches.size(), grid().size() * 7 / 10);
    EXPECT_LT(bias_of(matches).cwiseAbs().maxCoeff(), 0.1) << factor;
  }
}

TEST(TrackOnRoad, KeepsIdsAndStarts) {
  const Views views = render();
  const std::vector<TrackPoint> points{{7, {200.0, 150.0}}, {12, {260.0, 170.0}}};
  const Matches matches =
      track_on_road(views.first, views.second, points, {kMotion, kRoad}, *camera(), RoadTrackingOptions{}.klt);
  ASSERT_EQ(matches.size(), 2U);
  EXPECT_EQ(matches[0].id, 7);
  EXPECT_EQ(matches[0].pixel1, points[0].pixel);
  EXPECT_EQ(matches[1].id, 12);
  EXPECT_TRUE(track_on_road(views.first, views.second, {}, {kMotion, kRoad}, *camera(), {}).empty());
}

TEST(TrackOnRoad, FindsNothingOnABlackImage) {
  const Views views = render();
  EXPECT_TRUE(track_on_road(views.first, Image(480, 240), grid(), {kMotion, kRoad}, *camera(), {}).empty());
}

TEST(SearchWarp, FindsTheStepWithinOneOfItsOwn) {
  const Views views = render();
  const Image mask = region_mask({Eigen::Vector3d::UnitZ(), 0.0}, kRoad, *camera(), {});
  RigidTransform unit = kMotion;
  unit.translation.normalize();
  const WarpSearch found = search_warp(views.first, views.second, mask, {unit, kRoad}, *camera(), {});
  // Steps are tried 6 % apart.
  EXPECT_NEAR(found.warp.cam2_from_cam1.translation.norm() / kMotion.translation.norm(), 1.0, 0.06);
  EXPECT_GT(found.correlation, 0.8);
  EXPECT_DOUBLE_EQ(found.warp.road_in_cam1.height, kRoad.height);
}

TEST(SearchWarp, LeavesTheImagesAsTheyAre) {
  const Views views = render();
  const Views same = render();
  const Image mask = region_mask({Eigen::Vector3d::UnitZ(), 0.0}, kRoad, *camera(), {});
  search_warp(views.first, views.second, mask, {kMotion, kRoad}, *camera(), {});
  EXPECT_TRUE(std::equal(same.first.data(), same.first.data() + 480 * 240, views.first.data()));
  EXPECT_TRUE(std::equal(same.second.data(), same.second.data() + 480 * 240, views.second.data()));
}

TEST(SearchWarp, WithoutARegionOrTextureFindsNothing) {
  const Views views = render();
  EXPECT_EQ(search_warp(views.first, views.second, {}, {kMotion, kRoad}, *camera(), {}).correlation, -1.0);
  const Image mask = region_mask({Eigen::Vector3d::UnitZ(), 0.0}, kRoad, *camera(), {});
  const Image black(480, 240);
  EXPECT_EQ(search_warp(black, black, mask, {kMotion, kRoad}, *camera(), {}).correlation, -1.0);
}

}  // namespace
}  // namespace groundscale
