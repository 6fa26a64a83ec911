#include "groundscale/simulation/ray_scene.hpp"

#include <utility>

#include <gtest/gtest.h>

namespace groundscale {
namespace {

/// A square of 2 m across z, `z` metres ahead; uv are x and y.
TriangleMesh wall(double z, int material) {
  TriangleMesh mesh;
  mesh.material = material;
  std::uint32_t corners[4];
  const std::pair<double, double> places[] = {{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}};
  for (int k = 0; k < 4; ++k) {
    const auto [x, y] = places[k];
    corners[k] = mesh.add_vertex({x, y, z}, {x, y});
  }
  mesh.add_quad(corners[0], corners[1], corners[2], corners[3]);
  return mesh;
}

TEST(RayScene, TheNearestSurfaceIsHitWithItsDistanceNormalAndCoordinates) {
  const RayScene scene({wall(9.0, 3), wall(4.0, 7)});
  const Eigen::Vector3d direction = Eigen::Vector3d(0.1, -0.05, 1.0).normalized();
  const auto hit = scene.hit(Eigen::Vector3d::Zero(), direction);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->material, 7);
  EXPECT_EQ(hit->mesh, 1);
  EXPECT_NEAR(hit->distance_m, 4.0 / direction.z(), 1e-6);
  EXPECT_LT((hit->normal - Eigen::Vector3f(0.0F, 0.0F, -1.0F)).norm(), 1e-6);
  EXPECT_LT((hit->uv - Eigen::Vector2f(0.4F, -0.2F)).norm(), 1e-6);
}

TEST(RayScene, NothingIsHitBesideAndBehind) {
  const RayScene scene({wall(4.0, 0)});
  EXPECT_FALSE(scene.hit(Eigen::Vector3d::Zero(), -Eigen::Vector3d::UnitZ()));
  EXPECT_FALSE(scene.hit({3.0, 0.0, 0.0}, Eigen::Vector3d::UnitZ()));
  EXPECT_FALSE(RayScene({}).hit(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ()));
}

TEST(RayScene, ASurfaceDoesNotBlockRaysThatLeaveIt) {
  const RayScene scene({wall(4.0, 0), wall(9.0, 0)});
  EXPECT_TRUE(scene.blocked({0.0, 0.0, 4.0}, Eigen::Vector3d::UnitZ()));
  EXPECT_FALSE(scene.blocked({0.0, 0.0, 4.0}, -Eigen::Vector3d::UnitZ()));
  EXPECT_FALSE(scene.blocked({0.0, 0.0, 9.0}, Eigen::Vector3d::UnitZ()));
}

}  // namespace
}  // namespace groundscale
