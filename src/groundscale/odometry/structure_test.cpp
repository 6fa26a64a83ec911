#include "groundscale/odometry/structure.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "groundscale/core/rng.hpp"

namespace groundscale {
namespace {

constexpr double kFocalPx = 500.0;
constexpr double kFirstStep = 0.8;
constexpr double kSecondStep = 1.1;
const Eigen::Matrix3d kTurn = Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY()).toRotationMatrix();
const Eigen::Vector3d kAhead = Eigen::Vector3d(0.05, 0.0, 1.0).normalized();

/// Three cameras on a path and what they see of `count` points.
struct Scene {
  RigidTransform world_from_cam1{};
  RigidTransform world_from_cam2{kTurn, kFirstStep* kAhead};
  RigidTransform world_from_cam3{kTurn * kTurn, kFirstStep* kAhead + kSecondStep*(kTurn* kAhead)};
  std::vector<Eigen::Vector3d> points;

  explicit Scene(int count) {
    Rng rng(9);
    for (int k = 0; k < count; ++k)
      points.emplace_back(rng.uniform(3.0, 6.0), rng.uniform(-2.0, 2.0), rng.uniform(6.0, 12.0));
  }

  std::vector<RayPair> pairs(const RigidTransform& world_from_a, const RigidTransform& world_from_b) const {
    std::vector<RayPair> result;
    for (const Eigen::Vector3d& point : points) {
      result.push_back({static_cast<TrackId>(result.size()), (world_from_a.inverse() * point).normalized(),
                        (world_from_b.inverse() * point).normalized()});
    }
    return result;
  }

  TwoViewMotion motion(const RigidTransform& world_from_a, const RigidTransform& world_from_b) const {
    TwoViewMotion motion;
    motion.state = MotionState::kMoving;
    motion.cam2_from_cam1 = world_from_b.inverse() * world_from_a;
    motion.cam2_from_cam1.translation.normalize();
    for (int k = 0; k < static_cast<int>(points.size()); ++k) motion.inliers.push_back(k);
    return motion;
  }

  std::vector<StructurePoint> placed() const {
    return triangulate_pair(pairs(world_from_cam1, world_from_cam2), motion(world_from_cam1, world_from_cam2),
                            world_from_cam1, kFirstStep, kFocalPx, 3.0);
  }
  std::optional<StructureDistance> next_distance(const std::vector<StructurePoint>& known) const {
    return distance_from_structure(known, pairs(world_from_cam2, world_from_cam3),
                                   motion(world_from_cam2, world_from_cam3), world_from_cam2.translation, kFocalPx,
                                   3.0);
  }
};

TEST(Structure, OfExactRaysIsThePoints) {
  const Scene scene(40);
  const auto placed = scene.placed();
  ASSERT_EQ(placed.size(), 40U);
  for (const StructurePoint& point : placed) {
    EXPECT_LT((point.point_in_world - scene.points[static_cast<std::size_t>(point.id)]).norm(), 1e-9);
  }
}

TEST(Structure, TellsTheLengthOfTheNextBaseline) {
  const Scene scene(40);
  const auto found = scene.next_distance(scene.placed());
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->distance, kSecondStep, 1e-9);
  EXPECT_EQ(found->points, 40);
  EXPECT_LT(found->log_sd, 1e-9);
}

TEST(Structure, OutvotesPointsThatAreWrong) {
  const Scene scene(60);
  auto placed = scene.placed();
  for (std::size_t k = 0; k < placed.size(); k += 4) placed[k].point_in_world *= 3.0;
  const auto found = scene.next_distance(placed);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->distance, kSecondStep, 1e-6);
}

TEST(Structure, OfTooFewCommonPointsTellsNothing) {
  EXPECT_TRUE(Scene(15).next_distance(Scene(15).placed()));
  EXPECT_FALSE(Scene(14).next_distance(Scene(14).placed()));
  EXPECT_FALSE(Scene(40).next_distance({}));
}

}  // namespace
}  // namespace groundscale
