#include "groundscale/simulation/laid_road.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

using testing::HasSubstr;

/// Poses of a level camera that drives along a path, 1.65 m above it.
Trajectory poses_over(const Path& path, double step_m) {
  Trajectory trajectory;
  for (double s = 0.0; s <= path.length_m(); s += step_m) {
    const PathPoint point = path.at(s);
    const Eigen::Vector3d turn(0.0, point.heading_rad, 0.0);
    const Eigen::Matrix3d pitch = exp_so3({std::atan(point.slope), 0.0, 0.0});
    trajectory.world_from_cam.push_back({exp_so3(turn) * pitch, point.position - 1.65 * Eigen::Vector3d::UnitY()});
  }
  return trajectory;
}

/// A loop to the right over itself: the second pass crosses the first.
Path crossing(double rise_m) {
  std::vector<PathPiece> pieces = {{80.0, 0.0}};
  for (int corner = 0; corner < 3; ++corner) {
    for (const PathPiece& piece : turn_pieces(std::numbers::pi / 2.0, 12.0, 6.0)) pieces.push_back(piece);
  }
  pieces.push_back({60.0, 0.0});
  const double length = Path::of_pieces(pieces, {}).length_m();
  // A quarter of a wave: it rises all the way.
  return Path::of_pieces(pieces, {{rise_m, 4.0 * length, 0.0}});
}

TEST(LaidRoad, LiesUnderTheCameraAtItsHeight) {
  const Path path = Path::of_pieces({{60.0, 0.0}, {20.0, 0.03}, {60.0, 0.03}}, {{1.0, 150.0, 0.2}});
  const LaidRoad road = lay_road(poses_over(path, 0.9), {}, {}).value();
  const RoadSurface surface(road.path, {.roughness_m = 0.0});
  for (const RigidTransform& pose : road.world_from_cam) {
    const Eigen::Vector3d& camera = pose.translation;
    const Eigen::Vector3d beneath(camera.x(), surface.ground_y(camera.x(), camera.z()), camera.z());
    // Smoothing over 2 m takes 2^2 / 2 of the height's curvature, (2 pi / 150)^2 m at the most: 4 mm.
    EXPECT_NEAR(surface.ground_normal(camera.x(), camera.z()).dot(camera - beneath), 1.65, 0.01);
  }
  EXPECT_LT(road.largest_correction_m, 1e-6);
}

TEST(LaidRoad, KeepsTheVehiclesOwnMotion) {
  Trajectory poses = poses_over(Path::of_pieces({{100.0, 0.0}}, {}), 1.0);
  // A bump that lifts the camera by 2 cm in one frame, and pitches it by half a degree.
  poses.world_from_cam[50].translation.y() -= 0.02;
  poses.world_from_cam[50].rotation = exp_so3({0.0087, 0.0, 0.0});
  const LaidRoad road = lay_road(poses, {}, {}).value();
  const double above = road.path.at(road.distance_m[50]).position.y() - road.world_from_cam[50].translation.y();
  EXPECT_NEAR(above, 1.667, 0.002);
  const Eigen::Matrix3d before = road.world_from_cam[49].rotation;
  EXPECT_NEAR(log_so3(before.transpose() * road.world_from_cam[50].rotation).x(), 0.0087, 1e-4);
}

TEST(LaidRoad, HeightsThatDisagreeWhereThePathCrossesItselfArePutRightSmoothly) {
  const Path path = crossing(3.0);
  const LaidRoad road = lay_road(poses_over(path, 0.8), {}, {}).value();
  // Where the last straight comes over the first one.
  double worst = 0.0;
  int places = 0;
  for (double s1 = 0.0; s1 < 80.0; s1 += 0.25) {
    for (double s2 = path.length_m() - 60.0; s2 < path.length_m(); s2 += 0.25) {
      const Eigen::Vector3d apart = road.path.at(s2).position - road.path.at(s1).position;
      if (std::hypot(apart.x(), apart.z()) > 0.3) continue;
      worst = std::max(worst, std::abs(apart.y()));
      ++places;
    }
  }
  ASSERT_GT(places, 0);
  EXPECT_LT(worst, 0.01);
  EXPECT_GT(road.largest_correction_m, 0.5);
  for (double s = 1.0; s < road.path.length_m() - 1.0; s += 1.0) EXPECT_LT(std::abs(road.path.at(s).slope), 0.06) << s;
}

TEST(LaidRoad, ClimbsWhileTheCarStandsAreNoRoad) {
  Trajectory poses = poses_over(Path::of_pieces({{60.0, 0.0}}, {}), 1.0);
  // It stands for 20 frames after 30 m, and its height drifts by 4 m.
  const RigidTransform halt = poses.world_from_cam[30];
  std::vector<RigidTransform> standing(20, halt);
  for (std::size_t k = 0; k < standing.size(); ++k) {
    standing[k].translation.y() -= 0.2 * static_cast<double>(k + 1);
    standing[k].translation.x() += k % 2 == 0 ? 0.004 : -0.004;
  }
  for (std::size_t k = 31; k < poses.world_from_cam.size(); ++k) poses.world_from_cam[k].translation.y() -= 4.0;
  poses.world_from_cam.insert(poses.world_from_cam.begin() + 31, standing.begin(), standing.end());
  const LaidRoad road = lay_road(poses, {}, {}).value();
  for (std::size_t k = 0; k < road.world_from_cam.size(); ++k) {
    EXPECT_NEAR(road.world_from_cam[k].translation.y(), road.world_from_cam[0].translation.y(), 0.03) << k;
    EXPECT_GE(road.distance_m[k], road.distance_m[k == 0 ? 0 : k - 1]);
  }
  EXPECT_NEAR(road.distance_m[50], road.distance_m[31], 0.02);
}

std::string refusal(const Trajectory& poses) {
  const auto road = lay_road(poses, {}, {});
  return road ? "" : road.error().message;
}

TEST(LaidRoad, SaysWhyItCanNotBeLaid) {
  Trajectory one;
  one.world_from_cam.push_back({});
  EXPECT_THAT(refusal(one), HasSubstr("there is one pose, a drive needs two at least"));
  Trajectory jump = poses_over(Path::of_pieces({{60.0, 0.0}}, {}), 1.0);
  jump.world_from_cam[20].translation.x() = 300.0;
  EXPECT_THAT(refusal(jump), HasSubstr("pose 20, counted from 0, lies 300.0 m from the one before"));
  const Trajectory standing{std::vector<RigidTransform>(50), {}};
  EXPECT_THAT(refusal(standing), HasSubstr("a road needs 5 m"));
  EXPECT_THAT(
      refusal(poses_over(Path::of_pieces({{20.0, 0.0}, {4.0, 0.5}, {3.0, 0.5}, {4.0, 0.0}, {20.0, 0.0}}, {}), 0.3)),
      HasSubstr("the path turns too tightly for the road: radius 3."));
  Trajectory reversing = poses_over(Path::of_pieces({{40.0, 0.0}}, {}), 0.5);
  for (std::size_t k = reversing.world_from_cam.size(); k-- > 20;) {
    reversing.world_from_cam.push_back(reversing.world_from_cam[k]);
  }
  EXPECT_THAT(refusal(reversing), HasSubstr("the poses turn back on themselves 40 m from the start"));
  Trajectory backwards = poses_over(Path::of_pieces({{40.0, 0.0}}, {}), 0.5);
  std::reverse(backwards.world_from_cam.begin(), backwards.world_from_cam.end());
  EXPECT_THAT(refusal(backwards), HasSubstr("at pose 0, counted from 0, the vehicle points against its way"));
  // A camera that looks back, on a vehicle that drives forwards.
  EXPECT_TRUE(lay_road(backwards, {.yaw_deg = 180.0}, {}));
}

}  // namespace
}  // namespace groundscale
