#include "groundscale/odometry/pose_links.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

RigidTransform at(double z, double yaw_rad = 0.0) {
  return {exp_so3(Eigen::Vector3d(0.0, yaw_rad, 0.0)), Eigen::Vector3d(0.0, 0.0, z)};
}

PoseLink keyframe_link(int reference, const RigidTransform& as_tracked) {
  return {reference, as_tracked, 1.0, true, true, as_tracked};
}

/// A first frame, and a keyframe 4 units on with a frame at a quarter of the way.
PoseLinks two_keyframes() {
  PoseLinks links;
  links.add({});
  links.add({0, at(1.0), 1.0, true, false});
  links.add(keyframe_link(0, at(4.0)));
  return links;
}

TEST(PoseLinks, FramesFollowWhatBecameOfTheWayBetweenTheirKeyframes) {
  PoseLinks links = two_keyframes();
  links[2].reference_from_cam = at(8.0, 0.04);
  const auto poses = links.poses_m({});
  EXPECT_LT((poses[1].translation - Eigen::Vector3d(0.0, 0.0, 2.0)).norm(), 1e-12);
  EXPECT_LT((log_so3(poses[1].rotation) - Eigen::Vector3d(0.0, 0.01, 0.0)).norm(), 1e-12);
  EXPECT_LT((poses[2].translation - Eigen::Vector3d(0.0, 0.0, 8.0)).norm(), 1e-12);
}

TEST(PoseLinks, TheScaleOfTheWholeDriveCountsForTheMapsFramesAlone) {
  PoseLinks links = two_keyframes();
  links.add({2, at(1.0), 1.0, false, false});
  std::vector<MapScaleFilter::Smoothed> smoothed(4);
  for (auto& scale : smoothed) scale.log_scale = std::log(2.0);
  const auto poses = links.poses_m(smoothed);
  EXPECT_NEAR(poses[1].translation.z(), 2.0, 1e-12);
  EXPECT_NEAR(poses[2].translation.z(), 8.0, 1e-12);
  EXPECT_NEAR(poses[3].translation.z(), 9.0, 1e-12);  // the pairwise odometry's metres stay
}

TEST(PoseLinks, AKeyframeThatTheMapMovesTakesAlongWhatHangsOnIt) {
  const auto camera = PinholeCamera::create({400.0, 400.0, 320.0, 240.0}, 640, 480);
  LocalMap map(camera.value(), {});
  map.add(0, at(0.0).inverse(), {});
  map.add(2, at(5.0).inverse(), {});
  PoseLinks links = two_keyframes();
  links.add({2, at(1.0), 0.5, true, false});
  links[2].unit_m = 2.0;
  links.begin_map(map.keyframes().front(), at(100.0));
  links.place_keyframes(map);
  EXPECT_NEAR(links[2].reference_from_cam.translation.z(), 5.0, 1e-12);
  EXPECT_NEAR(links[2].as_tracked.translation.z(), 4.0, 1e-12);
  EXPECT_NEAR(links.latest_pose_m(map).translation.z(), 100.0 + 2.0 * 5.0 + 0.5 * 1.0, 1e-12);
}

TEST(PoseLinks, AMapThatBeginsAtAnOlderKeyframeLeavesTheFramesBeforeItAlone) {
  PoseLinks links = two_keyframes();
  links[2].reference_from_cam = at(8.0);  // frame 1 lies at a quarter of it
  links.add(keyframe_link(0, at(6.0)));   // another map, from frame 0 on,
  links[3].reference_from_cam = at(60.0);
  const auto poses = links.poses_m({});
  EXPECT_NEAR(poses[1].translation.z(), 2.0, 1e-12);
  EXPECT_NEAR(poses[3].translation.z(), 60.0, 1e-12);
}

}  // namespace
}  // namespace groundscale
