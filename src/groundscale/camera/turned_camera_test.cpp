#include "groundscale/camera/turned_camera.hpp"

#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"

namespace groundscale {
namespace {

CameraPtr pinhole(double cy, double k1) {
  return *PinholeCamera::create({.fx = 700, .fy = 700, .cx = 600, .cy = cy, .k1 = k1}, 1240, 370);
}

TEST(TurnedCamera, SeesTheOldAxisWhereItWas) {
  const CameraPtr before = pinhole(180, 0.0);
  const CameraPtr after = pinhole(184, 0.01);
  const TurnedCamera turned(after, turn_between(*before, *after));
  const auto axis = turned.project(Eigen::Vector3d::UnitZ());
  ASSERT_TRUE(axis.has_value());
  EXPECT_NEAR(axis->y(), 180.0, 1e-9);
  EXPECT_NEAR(axis->x(), 600.0, 1e-9);
}

TEST(TurnedCamera, RayIsInverseOfProjectAndDerivativeIsRight) {
  const CameraPtr before = pinhole(180, 0.0);
  const CameraPtr after = pinhole(184, 0.01);
  const TurnedCamera turned(after, turn_between(*before, *after));
  const Eigen::Vector3d ray(0.4, -0.1, 1.3);
  Eigen::Matrix<double, 2, 3> derivative;
  const auto pixel = turned.project(ray, &derivative);
  ASSERT_TRUE(pixel.has_value());
  EXPECT_LT((*turned.ray(*pixel) - ray.normalized()).norm(), 1e-9);
  for (int k = 0; k < 3; ++k) {
    constexpr double kStep = 1e-6;
    Eigen::Vector3d moved = ray;
    moved(k) += kStep;
    EXPECT_LT(((*turned.project(moved) - *pixel) / kStep - derivative.col(k)).norm(), 1e-2);
  }
}

TEST(TurnedCamera, SameCameraNeedsNoTurn) {
  const CameraPtr camera = pinhole(180, 0.02);
  EXPECT_LT((turn_between(*camera, *camera) - Eigen::Matrix3d::Identity()).norm(), 1e-9);
}

}  // namespace
}  // namespace groundscale
