#include "groundscale/geometry/rigid_transform.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace groundscale {
namespace {

const RigidTransform kCam2FromCam1{
    Eigen::AngleAxisd(0.3, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()).toRotationMatrix(), {0.2, -0.1, -1.5}};
const RigidTransform kCam3FromCam2{
    Eigen::AngleAxisd(-1.1, Eigen::Vector3d(0.0, 1.0, 0.3).normalized()).toRotationMatrix(), {-0.7, 0.4, 2.0}};
const Eigen::Vector3d kPoint(3.0, -1.0, 7.0);

Eigen::Matrix4d homogeneous(const RigidTransform& transform) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = transform.rotation;
  matrix.topRightCorner<3, 1>() = transform.translation;
  return matrix;
}

// Numbers of size 10 through a few products: rounding stays beneath 1e-14, a wrong sign or order shows at 1e-1.
constexpr double kTolerance = 1e-13;

TEST(RigidTransform, IsTheIdentityWhereNothingIsSaid) { EXPECT_EQ(RigidTransform{} * kPoint, kPoint); }

TEST(RigidTransform, TurnsThenShifts) {
  const RigidTransform quarter_turn_about_down{
      (Eigen::Matrix3d() << 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0).finished(), {10.0, 20.0, 30.0}};
  EXPECT_LT((quarter_turn_about_down * Eigen::Vector3d(1.0, 2.0, 3.0) - Eigen::Vector3d(13.0, 22.0, 29.0)).norm(),
            kTolerance);
}

TEST(RigidTransform, NeighboursCancelAsTheirHomogeneousMatricesDo) {
  const RigidTransform cam3_from_cam1 = kCam3FromCam2 * kCam2FromCam1;
  EXPECT_LT((homogeneous(cam3_from_cam1) - homogeneous(kCam3FromCam2) * homogeneous(kCam2FromCam1)).norm(), kTolerance);
  EXPECT_LT((cam3_from_cam1 * kPoint - kCam3FromCam2 * (kCam2FromCam1 * kPoint)).norm(), kTolerance);
}

TEST(RigidTransform, InverseUndoesItFromBothSides) {
  EXPECT_LT((kCam2FromCam1.inverse() * (kCam2FromCam1 * kPoint) - kPoint).norm(), kTolerance);
  EXPECT_LT((homogeneous(kCam2FromCam1 * kCam2FromCam1.inverse()) - Eigen::Matrix4d::Identity()).norm(), kTolerance);
}

}  // namespace
}  // namespace groundscale
