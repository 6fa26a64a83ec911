#include "groundscale/mapping/drive_recorder.hpp"

#include <gtest/gtest.h>

namespace groundscale {
namespace {

/// Twenty points that have moved to the right.
std::vector<TrackPoint> points_at(double x, TrackId first = 0) {
  std::vector<TrackPoint> points;
  for (int k = 0; k < 20; ++k) points.push_back({first + k, {x + 10.0 * k, 5.0 * k}});
  return points;
}

TEST(DriveRecorder, KeepsAFrameOnceItsTracksHaveMoved) {
  DriveRecorder recorder({.view_px = 5.0, .view_share = 0.6});
  for (int k = 0; k <= 6; ++k) recorder.add(k, 100 + k, points_at(2.0 * k));
  std::vector<RigidTransform> world_from_cam(7);
  for (int k = 0; k <= 6; ++k) world_from_cam[static_cast<std::size_t>(k)].translation.z() = k;
  const DriveTracks drive = recorder.drive(world_from_cam);
  // After 6 px, each time.
  ASSERT_EQ(drive.views.size(), 3U);
  EXPECT_EQ(drive.views[1].frame, 103);
  EXPECT_EQ(drive.views[2].cam_from_world.translation.z(), -6.0);
  ASSERT_EQ(drive.tracks.size(), 20U);
  ASSERT_EQ(drive.tracks[4].sights.size(), 3U);
  EXPECT_EQ(drive.tracks[4].sights[2].view, 2);
  EXPECT_EQ(drive.tracks[4].sights[2].pixel, Eigen::Vector2d(52.0, 20.0));
}

TEST(DriveRecorder, KeepsAFrameThatHasLostMostTracks) {
  DriveRecorder recorder({.view_px = 50.0, .view_share = 0.6});
  recorder.add(0, 0, points_at(0.0));
  recorder.add(1, 1, points_at(1.0));
  recorder.add(2, 2, points_at(2.0, 10));  // half of them are new
  const DriveTracks drive = recorder.drive(std::vector<RigidTransform>(3));
  ASSERT_EQ(drive.views.size(), 2U);
  EXPECT_EQ(drive.views[1].frame, 2);
  EXPECT_EQ(drive.tracks.size(), 10U);  // those seen once are of no use
}

TEST(DriveRecorder, OfNothingIsNothing) { EXPECT_TRUE(DriveRecorder({}).drive({}).views.empty()); }

}  // namespace
}  // namespace groundscale
