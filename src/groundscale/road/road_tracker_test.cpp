#include "groundscale/road/road_tracker.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/road/region.hpp"
#include "groundscale/tracking/test_texture_internal.hpp"

namespace groundscale {
namespace {

const GroundPlane kRoad{Eigen::Vector3d(0.01, 1.0, 0.02).normalized(), 1.65};
const RigidTransform kMotion{Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY()).toRotationMatrix(), {0.02, 0.01, -0.8}};

CameraPtr camera() { return *PinholeCamera::create({.fx = 400.0, .fy = 400.0, .cx = 240.0, .cy = 60.0}, 480, 240); }

/// Both views of a textured road by intersecting each pixel's ray with the plane; above the horizon is grey.
struct Views {
  Image first, second;
};

/// The road's point that a pixel of a camera shows, as coordinates in camera 1, metres.
Eigen::Vector2d on_road(double x, double y, const GroundPlane& road, const RigidTransform& cam1_from_cam) {
  const Eigen::Vector3d ray((x - 240.0) / 400.0, (y - 60.0) / 400.0, 1.0);
  const double slope = std::max(road.normal_in_cam.dot(ray), 0.03);  // no farther than 55 m
  const Eigen::Vector3d point = cam1_from_cam * Eigen::Vector3d(ray * (road.height / slope));
  return {point.x(), point.z()};
}

Views render() {
  // 0.3 m at the shortest: 5 px deep 9 m ahead, where points begin to be wanted, so that neither view aliases.
  const TestTexture texture(8, 0.3);
  const auto view = [&](const GroundPlane& road, const RigidTransform& cam1_from_cam) {
    return texture.render(480, 240, [&](int x, int y) { return on_road(x, y, road, cam1_from_cam); });
  };
  return {view(kRoad, {}), view(kRoad.seen_from(kMotion), kMotion.inverse())};
}

std::vector<TrackPoint> grid() {
  std::vector<TrackPoint> points;
  for (int y = 140; y <= 190; y += 10) {
    for (int x = 150; x <= 330; x += 12) points.push_back({static_cast<TrackId>(points.size()), {x, y}});
  }
  return points;
}

/// Median over the matches of the error in x and in y against the plane's own homography.
Eigen::Vector2d bias_of(const Matches& matches) {
  std::vector<double> dx, dy;
  for (const Match& match : matches) {
    const Eigen::Vector3d ray((match.pixel1.x() - 240.0) / 400.0, (match.pixel1.y() - 60.0) / 400.0, 1.0);
    const Eigen::Vector3d point2 = kMotion * Eigen::Vector3d(ray * (kRoad.height / kRoad.normal_in_cam.dot(ray)));
    dx.push_back(match.pixel2.x() - (400.0 * point2.x() / point2.z() + 240.0));
    dy.push_back(match.pixel2.y() - (400.0 * point2.y() / point2.z() + 60.0));
  }
  const auto middle = [](std::vector<double>& values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
  };
  return {middle(dx), middle(dy)};
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
