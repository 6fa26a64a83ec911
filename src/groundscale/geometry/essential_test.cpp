#include "groundscale/geometry/essential.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "groundscale/core/rng.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

const RigidTransform kCam2FromCam1{exp_so3({0.01, 0.05, -0.02}), Eigen::Vector3d(0.1, -0.05, -1.0).normalized()};
const Eigen::Vector3d kPointInCam1(2.0, 1.5, 9.0);

TEST(Essential, OfAPointSeenInBothViewsTheErrorIsZero) {
  const Eigen::Matrix3d essential = essential_matrix(kCam2FromCam1);
  const Eigen::Vector3d ray1 = kPointInCam1.normalized();
  const Eigen::Vector3d ray2 = (kCam2FromCam1 * kPointInCam1).normalized();
  EXPECT_NEAR(ray2.dot(essential * ray1), 0.0, 1e-15);
  EXPECT_NEAR(epipolar_error_rad(essential, ray1, ray2), 0.0, 1e-15);
}

TEST(Essential, TheErrorIsTheLeastTurnOfBothRaysThatMakesThemMeet) {
  // Both rays are turned off their epipolar planes by small angles a, b about axes in those planes. The least turn that
  // mends it, sqrt(a^2 + b^2) at the least, is found by brute force along the trade between the two.
  const Eigen::Matrix3d essential = essential_matrix(kCam2FromCam1);
  const Eigen::Vector3d ray1 = kPointInCam1.normalized();
  const Eigen::Vector3d ray2 = (kCam2FromCam1 * kPointInCam1).normalized();
  const Eigen::Vector3d axis2 = (essential * ray1).cross(ray2).normalized();
  const Eigen::Vector3d axis1 = (essential.transpose() * ray2).cross(ray1).normalized();
  constexpr double kTurn = 1e-4;
  const Eigen::Vector3d turned2 = exp_so3(kTurn * axis2) * ray2;
  double least = 1.0;
  for (int k = -200; k <= 200; ++k) {
    const double a = kTurn * 0.01 * k;  // turn of ray 1; the turn of ray 2 that is then left solves a linear equation
    const Eigen::Vector3d mended1 = exp_so3(a * axis1) * ray1;
    const Eigen::Vector3d normal = (essential * mended1).normalized();
    const double b = std::asin(turned2.dot(normal));
    least = std::min(least, std::hypot(a, b));
  }
  // First order in an angle of 1e-4, and a grid of 1e-2 about a minimum: relative error of 1e-3.
  EXPECT_NEAR(std::abs(epipolar_error_rad(essential, ray1, turned2)), least, 1e-3 * least);
}

TEST(Essential, TheErrorChangesItsSignWithTheSide) {
  const Eigen::Matrix3d essential = essential_matrix(kCam2FromCam1);
  const Eigen::Vector3d ray1 = kPointInCam1.normalized();
  const Eigen::Vector3d ray2 = (kCam2FromCam1 * kPointInCam1).normalized();
  const Eigen::Vector3d axis = (essential * ray1).cross(ray2).normalized();
  EXPECT_LT(epipolar_error_rad(essential, ray1, exp_so3(1e-3 * axis) * ray2) *
                epipolar_error_rad(essential, ray1, exp_so3(-1e-3 * axis) * ray2),
            0.0);
}

TEST(TriangulateDepths, AreTheDistancesFromBothCameras) {
  const Eigen::Vector3d point_in_cam2 = kCam2FromCam1 * kPointInCam1;
  const RayDepths depths = triangulate_depths(kCam2FromCam1, kPointInCam1.normalized(), point_in_cam2.normalized());
  // The rays meet at an angle of about 0.04 rad; its square divides the rounding.
  EXPECT_NEAR(depths.along_ray1, kPointInCam1.norm(), 1e-10);
  EXPECT_NEAR(depths.along_ray2, point_in_cam2.norm(), 1e-10);
}

TEST(TriangulateDepths, AreNegativeBehindTheCameras) {
  const Eigen::Vector3d point_in_cam2 = kCam2FromCam1 * kPointInCam1;
  const RayDepths depths = triangulate_depths(kCam2FromCam1, -kPointInCam1.normalized(), -point_in_cam2.normalized());
  EXPECT_NEAR(depths.along_ray1, -kPointInCam1.norm(), 1e-10);
  EXPECT_NEAR(depths.along_ray2, -point_in_cam2.norm(), 1e-10);
}

TEST(TriangulateDepths, OfRaysThatMissAreTheirLeastDistance) {
  Rng rng(4);
  const Eigen::Vector3d ray1 = Eigen::Vector3d(0.3, 0.2, 1.0).normalized();
  const Eigen::Vector3d ray2 = Eigen::Vector3d(0.5, 0.28, 1.0).normalized();
  const auto distance = [&](double d1, double d2) { return (kCam2FromCam1 * (d1 * ray1) - d2 * ray2).norm(); };
  const RayDepths depths = triangulate_depths(kCam2FromCam1, ray1, ray2);
  const double least = distance(depths.along_ray1, depths.along_ray2);
  EXPECT_GT(least, 1e-3);
  for (int trial = 0; trial < 100; ++trial) {
    EXPECT_GE(distance(depths.along_ray1 + 0.01 * rng.normal(), depths.along_ray2 + 0.01 * rng.normal()), least);
  }
}

TEST(TriangulateDepths, OfParallelRaysAreInfinite) {
  const RigidTransform sideways{Eigen::Matrix3d::Identity(), {-1.0, 0.0, 0.0}};
  const RayDepths depths = triangulate_depths(sideways, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitZ());
  EXPECT_TRUE(std::isinf(depths.along_ray1));
  EXPECT_TRUE(std::isinf(depths.along_ray2));
}

}  // namespace
}  // namespace groundscale
