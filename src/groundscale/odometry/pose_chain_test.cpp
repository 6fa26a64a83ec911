#include "groundscale/odometry/pose_chain.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace groundscale {
namespace {

FrameResult link_to(int reference, const Eigen::Vector3d& direction) {
  FrameResult link;
  link.reference = reference;
  link.reference_from_cam = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()).toRotationMatrix();
  link.direction_in_reference = direction.isZero() ? direction : Eigen::Vector3d(direction.normalized());
  return link;
}

const RigidTransform kReference{Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix(),
                                {5.0, -1.0, 2.0}};

TEST(Place, KeepsTheStepAndTheRayOfTheLink) {
  const FrameResult link = link_to(0, {0.1, 0.0, 1.0});
  RigidTransform previous = kReference;
  previous.translation += kReference.rotation * Eigen::Vector3d(0.0, 0.02, 0.8);
  const RigidTransform pose = place(link, kReference, previous, 0.9);
  EXPECT_NEAR((pose.translation - previous.translation).norm(), 0.9, 1e-12);
  const Eigen::Vector3d seen = kReference.inverse() * pose.translation;
  EXPECT_LT((seen.normalized() - link.direction_in_reference).norm(), 1e-12);
  EXPECT_GT(seen.norm(), 1.5);  // onwards, not back towards the reference
  EXPECT_LT((pose.rotation - kReference.rotation * link.reference_from_cam).norm(), 1e-12);
}

TEST(Place, TakesTheNearestPointOfTheRayWhereTheStepDoesNotReachIt) {
  const FrameResult link = link_to(0, {0.0, 0.0, 1.0});
  RigidTransform previous;
  previous.translation = {0.5, 0.0, 2.0};  // half a metre beside the ray
  const RigidTransform pose = place(link, {}, previous, 0.3);
  EXPECT_LT((pose.translation - Eigen::Vector3d(0.0, 0.0, 2.0)).norm(), 1e-12);
}

TEST(Place, WithoutADirectionStaysWhereTheFrameBeforeWas) {
  RigidTransform previous;
  previous.translation = {0.5, 0.1, 2.0};
  EXPECT_EQ(place(link_to(0, Eigen::Vector3d::Zero()), kReference, previous, 3.0).translation, previous.translation);
}

TEST(ChainPoses, HaveTheStepsBetweenNeighboursWhateverTheLinks) {
  std::vector<FrameResult> results{FrameResult{}};
  for (const int reference : {0, 1, 1, 3}) results.push_back(link_to(reference, {0.02, 0.01, 1.0}));
  const std::vector<double> steps{0.0, 0.7, 0.8, 0.9, 1.0};
  const auto poses = chain_poses(results, steps);
  ASSERT_EQ(poses.size(), results.size());
  EXPECT_TRUE(poses[0].translation.isZero());
  for (std::size_t k = 1; k < poses.size(); ++k) {
    EXPECT_NEAR((poses[k].translation - poses[k - 1].translation).norm(), steps[k], 1e-12) << k;
  }
}

}  // namespace
}  // namespace groundscale
