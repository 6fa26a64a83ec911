#include "groundscale/odometry/map_trail.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

RigidTransform cam_at(double z, double yaw_rad = 0.0) {
  return RigidTransform{exp_so3(Eigen::Vector3d(0.0, yaw_rad, 0.0)), Eigen::Vector3d(0.0, 0.0, z)}.inverse();
}

double z_of(const RigidTransform& cam_from_world) { return cam_from_world.inverse().translation.z(); }

/// A frame each 0.1 s, a unit apart.
MapTrail straight(int count) {
  MapTrail trail;
  for (int k = 0; k < count; ++k) trail.add(k, 0.1 * k, cam_at(k));
  return trail;
}

TEST(MapTrail, PredictsConstantVelocity) {
  EXPECT_NEAR(z_of(straight(1).predicted_pose(5.0)), 0.0, 1e-12);
  const MapTrail trail = straight(3);
  EXPECT_NEAR(z_of(trail.predicted_pose(0.3)), 3.0, 1e-12);
  EXPECT_NEAR(z_of(trail.predicted_pose(0.25)), 2.5, 1e-12);
  EXPECT_NEAR(z_of(trail.predicted_pose(60.0)), 22.0, 1e-9);  // 20 steps on, not 598
  EXPECT_NEAR(trail.latest_step().translation.z(), 1.0, 1e-12);
}

TEST(MapTrail, FramesBetweenLieEvenly) {
  const MapTrail trail = straight(3);
  const RigidTransform later = cam_at(6.0, 0.4);
  const RigidTransform quarter = trail.pose_between(later, 0.6, 0.3);
  EXPECT_NEAR(log_so3(quarter.rotation).y(), -0.1, 1e-12);
  EXPECT_LT((trail.pose_between(later, 0.6, 0.6).translation - later.translation).norm(), 1e-12);
  EXPECT_NEAR(z_of(trail.pose_between(later, 0.6, 0.1)), 2.0, 1e-12);  // not before the latest one
}

TEST(MapTrail, FollowsItsKeyframes) {
  const auto camera = PinholeCamera::create({400.0, 400.0, 320.0, 240.0}, 640, 480);
  LocalMap map(camera.value(), {});
  map.add(0, cam_at(10.0), {});
  MapTrail trail;
  trail.add(7, 0.7, cam_at(8.0));
  trail.add(8, 0.8, cam_at(3.0), {.serial = 0, .frame = 0, .cam_from_world = cam_at(2.0), .points = {}});
  trail.add(9, 0.9, cam_at(4.0), {.serial = 5, .frame = 0, .cam_from_world = cam_at(2.0), .points = {}});
  trail.follow(map);
  EXPECT_NEAR(z_of(trail.frames()[0].cam_from_world), 8.0, 1e-12);  // from before the map
  EXPECT_NEAR(z_of(trail.frames()[1].cam_from_world), 11.0, 1e-12);
  EXPECT_NEAR(z_of(trail.frames()[2].cam_from_world), 4.0, 1e-12);  // its keyframe has left the map
}

TEST(MapTrail, ForgetsAllButTheLatest) {
  MapTrail trail = straight(10);
  trail.forget_after(7);
  EXPECT_EQ(trail.latest().index, 7);
  trail.forget_before(2);
  EXPECT_EQ(trail.frames().front().index, 2);
  trail.forget_behind(8.0, 2.0);  // 4 units
  EXPECT_EQ(trail.frames().front().index, 3);
  trail.forget_behind(0.0, 1.0);
  EXPECT_EQ(trail.frames().size(), 3u);
  trail.forget_before(100);
  EXPECT_EQ(trail.frames().size(), 2u);
  trail.forget_after(-1);
  EXPECT_EQ(trail.frames().size(), 1u);
}

TEST(MapTrail, GrowsWithTheMap) {
  const auto camera = PinholeCamera::create({400.0, 400.0, 320.0, 240.0}, 640, 480);
  LocalMap map(camera.value(), {});
  map.add(0, cam_at(10.0), {});
  MapTrail trail;
  trail.add(8, 0.8, cam_at(11.0), map.keyframes().front());
  trail.scale(1.5);
  trail.follow(map);
  EXPECT_NEAR(z_of(trail.frames()[0].cam_from_world), 11.5, 1e-12);
}

}  // namespace
}  // namespace groundscale
