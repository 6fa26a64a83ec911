#include "groundscale/mapping/road_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/road/region.hpp"
#include "groundscale/tracking/test_texture_internal.hpp"

namespace groundscale {
namespace {

constexpr int kWidth = 480;
constexpr int kHeight = 240;
constexpr double kFocalPx = 400.0;
const GroundPlane kRoad{Eigen::Vector3d::UnitY(), 1.65};  // in the world, which is the first camera

CameraPtr camera() {
  return *PinholeCamera::create({.fx = kFocalPx, .fy = kFocalPx, .cx = 240.0, .cy = 60.0}, kWidth, kHeight);
}

/// World from the camera of a frame of a slow bend: half a metre and a third of a degree each.
RigidTransform pose(int frame) {
  const double turn = 0.006 * frame;
  return {exp_so3(turn * Eigen::Vector3d::UnitY()), {0.0015 * frame * frame, 0.0, 0.5 * frame}};
}

RigidTransform cam_from_world(int frame) { return pose(frame).inverse(); }

std::vector<RigidTransform> poses_from(int first, int count) {
  std::vector<RigidTransform> poses;
  for (int k = 0; k < count; ++k) poses.push_back(cam_from_world(first + k));
  return poses;
}

/// What a frame shows of the textured road; above the horizon is its far end. Kept, for the waves take a while.
const Image& render(int frame) {
  static const TestTexture texture(8, 0.3);
  static std::map<int, Image> kept;
  const auto found = kept.find(frame);
  if (found != kept.end()) return found->second;
  return kept[frame] = texture.render(kWidth, kHeight, [&](int x, int y) {
    const Eigen::Vector3d ray((x - 240.0) / kFocalPx, (y - 60.0) / kFocalPx, 1.0);
    const Eigen::Vector3d in_cam = ray * (kRoad.height / std::max(ray.y(), 0.03));  // no farther than 55 m
    const Eigen::Vector3d point = pose(frame) * in_cam;
    return Eigen::Vector2d(point.x(), point.z());
  });
}

Image region() {
  RegionOptions options;
  options.far_m = 12.0;
  return region_mask({Eigen::Vector3d::UnitZ(), 0.0}, kRoad, *camera(), options);
}

RoadWarp warp(int view, int frame) { return {cam_from_world(frame) * pose(view), kRoad}; }

RoadTracks tracks(const RoadTracksOptions& options = {}) { return {camera(), RoadTrackingOptions{}, options}; }

/// Looks at every frame.
void drive(RoadTracks& road, int first, int last) {
  for (int k = first; k <= last; ++k) {
    const Image& image = render(k);
    if (road.view_frame() >= 0) road.follow(image, k, warp(road.view_frame(), k));
    road.look(image, k, region());
  }
}

std::set<TrackId> ids_of(const std::vector<RoadTracks::Point>& points) {
  std::set<TrackId> ids;
  for (const auto& point : points) ids.insert(point.id);
  return ids;
}

TEST(RoadTracks, PointsLieOnTheRoad) {
  RoadTracks road = tracks();
  drive(road, 0, 6);
  const auto points = road.points(poses_from(0, 7), 0);
  ASSERT_GT(points.size(), 150U);
  std::vector<double> heights;
  for (const auto& point : points) heights.push_back(point.point_in_world.y());
  std::sort(heights.begin(), heights.end());
  // A point 6 m away with 2 m of baseline and 0.1 px is good for 5 mm; the middle of many for a tenth of that.
  EXPECT_NEAR(heights[heights.size() / 2], kRoad.height, 0.003);
  EXPECT_NEAR(heights[heights.size() / 10], kRoad.height, 0.03);
  EXPECT_NEAR(heights[heights.size() * 9 / 10], kRoad.height, 0.03);
  EXPECT_TRUE(std::is_sorted(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.id < b.id; }));
}

TEST(RoadTracks, SomePointsAreFollowedOverManyViews) {
  RoadTracks road = tracks();
  drive(road, 0, 0);
  const std::size_t first = road.view().points.size();
  const TrackId last_id = road.view().points.back().id;
  ASSERT_GT(first, 100U);
  drive(road, 1, 5);
  EXPECT_EQ(road.view_frame(), 5);
  const auto kept = std::count_if(road.view().points.begin(), road.view().points.end(),
                                  [&](const TrackPoint& point) { return point.id <= last_id; });
  // 2.5 m of the strip's 8 m have gone by below the image. More are tried than are wanted.
  const std::size_t most = std::min(first, static_cast<std::size_t>(RoadTrackingOptions{}.max_points));
  EXPECT_GT(kept, static_cast<long>(most) / 5);
  EXPECT_GT(road.view().points.size(), first * 8 / 10);  // filled up again
}

TEST(RoadTracks, FollowingIsFromTheViewUntilAnotherOneIsLookedAt) {
  RoadTracks road = tracks();
  drive(road, 0, 0);
  const std::size_t count = road.view().points.size();
  for (int k = 1; k <= 3; ++k) {
    const Matches& matches = road.follow(render(k), k, warp(0, k));
    EXPECT_EQ(road.view_frame(), 0);
    EXPECT_EQ(road.view().points.size(), count);
    EXPECT_GT(matches.size(), count / 3);  // the others left the image
  }
  // Four sights of each without a new point.
  const auto points = road.points(poses_from(0, 4), 0);
  EXPECT_GT(points.size(), count / 3);
  EXPECT_LE(points.size(), count);
}

TEST(RoadTracks, AFrameThatWasNotFollowedIntoBeginsAnew) {
  RoadTracks road = tracks();
  drive(road, 0, 0);
  const TrackId last_id = road.view().points.back().id;
  road.follow(render(1), 1, warp(0, 1));
  // Pixels of frame 1 are none of frame 4.
  road.look(render(4), 4, region());
  ASSERT_FALSE(road.view().points.empty());
  EXPECT_GT(road.view().points.front().id, last_id);
}

TEST(RoadTracks, ABlackImageEndsAllTracks) {
  RoadTracks road = tracks();
  drive(road, 0, 3);
  const TrackId last_id = road.view().points.back().id;
  const Image black(kWidth, kHeight);
  EXPECT_TRUE(road.follow(black, 4, warp(3, 4)).empty());
  road.look(black, 4, region());
  EXPECT_TRUE(road.view().points.empty());
  drive(road, 5, 5);
  ASSERT_FALSE(road.view().points.empty());
  EXPECT_GT(road.view().points.front().id, last_id);
  // What was seen before lies where it lay.
  EXPECT_GT(road.points(poses_from(0, 6), 0).size(), 50U);
}

TEST(RoadTracks, WithoutParallaxThereIsNoPoint) {
  RoadTracks road = tracks();
  const Image& image = render(0);
  road.look(image, 0, region());
  for (int k = 1; k <= 4; ++k) road.follow(image, k, warp(0, 0));
  EXPECT_TRUE(road.points(std::vector<RigidTransform>(5), 0).empty());
}

TEST(RoadTracks, ParallaxAndErrorAreOptions) {
  RoadTracks few = tracks({.min_parallax_px = 60.0});
  RoadTracks exact = tracks({.max_error_px = 0.01});
  RoadTracks all = tracks();
  for (RoadTracks* road : {&few, &exact, &all}) drive(*road, 0, 4);
  const std::size_t count = all.points(poses_from(0, 5), 0).size();
  EXPECT_LT(few.points(poses_from(0, 5), 0).size(), count * 8 / 10);
  EXPECT_LT(exact.points(poses_from(0, 5), 0).size(), count * 8 / 10);
  EXPECT_FALSE(exact.points(poses_from(0, 5), 0).empty());
}

TEST(RoadTracks, WrongPosesAreSeenInTheError) {
  RoadTracks road = tracks();
  drive(road, 0, 4);
  std::vector<RigidTransform> poses = poses_from(0, 5);
  const std::size_t right = road.points(poses, 0).size();
  poses[2].translation.y() += 0.3;
  EXPECT_LT(road.points(poses, 0).size(), right / 4);
}

TEST(RoadTracks, SightsOfFramesWithoutAPoseDoNotCount) {
  RoadTracks road = tracks();
  drive(road, 0, 6);
  const auto early = road.points(poses_from(0, 4), 0);
  const auto late = road.points(poses_from(3, 4), 3);
  EXPECT_FALSE(early.empty());
  EXPECT_FALSE(late.empty());
  EXPECT_TRUE(road.points(poses_from(0, 2), 0).empty());  // two sights are too few
  EXPECT_TRUE(road.points({}, 0).empty());
  EXPECT_NE(ids_of(early), ids_of(late));
}

TEST(RoadTracks, ManySightsAreThinnedEvenly) {
  RoadTracks thin = tracks({.max_sights = 2});
  drive(thin, 0, 6);
  const auto points = thin.points(poses_from(0, 7), 0);
  ASSERT_GT(points.size(), 100U);
  std::vector<double> heights;
  for (const auto& point : points) heights.push_back(point.point_in_world.y());
  std::sort(heights.begin(), heights.end());
  // First and last sight: the same place from fewer pixels.
  EXPECT_NEAR(heights[heights.size() / 2], kRoad.height, 0.005);
}

TEST(RoadTracks, ForgetsWhatWasNotSeenForLong) {
  RoadTracks road = tracks();
  drive(road, 0, 6);
  const auto before = road.points(poses_from(0, 7), 0);
  road.forget_before(4);
  const auto after = road.points(poses_from(0, 7), 0);
  EXPECT_LT(after.size(), before.size());
  EXPECT_FALSE(after.empty());
  road.forget_before(7);
  EXPECT_TRUE(road.points(poses_from(0, 7), 0).empty());
  // The view's points are still there to be followed.
  EXPECT_FALSE(road.follow(render(7), 7, warp(6, 7)).empty());
}

TEST(RoadTracks, ClearedKnowsNothingAndGivesNewIds) {
  RoadTracks road = tracks();
  drive(road, 0, 3);
  const TrackId last_id = road.view().points.back().id;
  road.clear();
  EXPECT_EQ(road.view_frame(), -1);
  EXPECT_TRUE(road.view().points.empty());
  EXPECT_TRUE(road.points(poses_from(0, 4), 0).empty());
  EXPECT_TRUE(road.follow(render(4), 4, warp(3, 4)).empty());
  drive(road, 5, 5);
  EXPECT_GT(road.view().points.front().id, last_id);
}

}  // namespace
}  // namespace groundscale
