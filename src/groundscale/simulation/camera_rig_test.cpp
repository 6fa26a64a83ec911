#include "groundscale/simulation/camera_rig.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

RoadSurface road(const std::vector<PathPiece>& pieces, const std::vector<HeightWave>& waves, double crown) {
  RoadProfile profile;
  profile.crown = crown;
  profile.roughness_m = 0.0;
  return RoadSurface(Path::of_pieces(pieces, waves), profile);
}

TEST(CameraRig, OnALevelRoadTheRoadLiesAsTheMountingSays) {
  CameraRig rig;
  rig.pitch_deg = 2.0;
  rig.roll_deg = -1.0;
  rig.yaw_deg = 5.0;
  const RoadSurface surface = road({{100.0, 0.0}}, {}, 0.0);
  const RigidTransform pose = camera_at_rest(surface, 30.0, rig);
  EXPECT_LT((pose.translation - Eigen::Vector3d(0.0, -1.65, 30.0)).norm(), 1e-9);
  const Eigen::Vector3d normal = pose.rotation.transpose() * Eigen::Vector3d::UnitY();
  EXPECT_LT((normal - rig.mounting().normal_in_cam()).norm(), 1e-9);
  const Eigen::Vector3d forward = pose.rotation.transpose() * Eigen::Vector3d::UnitZ();
  EXPECT_LT((forward - rig.mounting().forward_in_cam()).norm(), 1e-9);
  EXPECT_NEAR(pose.rotation.determinant(), 1.0, 1e-12);
}

TEST(CameraRig, TheCameraKeepsItsHeightAboveGradeAndCrossFall) {
  const CameraRig rig;
  const RoadSurface surface = road({{100.0, 0.0}}, {{3.0, 120.0, 0.4}}, 0.03);
  const RigidTransform pose = camera_at_rest(surface, 40.0, rig);
  // The plane through three places of the lane near the camera.
  const auto ground = [&](double x, double z) { return Eigen::Vector3d(x, surface.ground_y(x, z), z); };
  const Eigen::Vector3d a = ground(0.0, 40.0);
  const Eigen::Vector3d normal = (ground(0.0, 40.1) - a).cross(ground(0.1, 40.0) - a).normalized();
  EXPECT_NEAR(normal.dot(a - pose.translation), 1.65, 1e-3);  // the grade changes a little within 10 cm
  EXPECT_LT((pose.rotation.col(1) - normal).norm(), 1e-3);
}

TEST(CameraRig, TheVehicleNodsWhenBrakingLeansOutwardsAndRestsWhenStanding) {
  CameraRig rig;
  rig.shake_pitch_sd_deg = rig.shake_roll_sd_deg = rig.bounce_sd_m = 0.0;
  const RoadSurface surface = road({{50.0, 0.0}, {10.0, 0.02}, {60.0, 0.02}}, {}, 0.0);
  const auto poses =
      camera_poses(surface, {{0.0, 30.0, 8.0, -2.0}, {1.0, 90.0, 10.0, 0.0}, {2.0, 30.0, 0.0, 0.0}}, rig, 1);
  const auto angles_of = [](const RigidTransform& pose) {
    return plane_angles(pose.rotation.transpose() * Eigen::Vector3d::UnitY());
  };
  EXPECT_NEAR(angles_of(poses[0]).pitch_rad, 0.6 * kDegree, 1e-9);  // looks down
  EXPECT_NEAR(angles_of(poses[1]).roll_rad, -0.7 * kDegree, 1e-6);  // right turn: the left side is lower
  EXPECT_NEAR(angles_of(poses[2]).pitch_rad, 0.0, 1e-12);
}

}  // namespace
}  // namespace groundscale
