#include "groundscale/experiments/synthetic_trial.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/geometry/ground_plane.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

constexpr double kFocalPx = 700.0;

SyntheticWorld world_of_test() {
  SyntheticWorld world;
  world.camera = *PinholeCamera::create({.fx = kFocalPx, .fy = kFocalPx, .cx = 600.0, .cy = 180.0}, 1200, 370);
  return world;
}

std::vector<Eigen::Vector2d> grid_of_features() {
  std::vector<Eigen::Vector2d> features;
  for (int v = 240; v < 340; v += 10) {
    for (int u = 450; u < 750; u += 30) features.emplace_back(u, v);
  }
  return features;
}

const RigidTransform kMotion{exp_so3(Eigen::Vector3d(0.002, 0.01, -0.003)), Eigen::Vector3d(0.02, 0.01, -0.8)};

TEST(SyntheticTrial, RoadPointsFollowTheHomographyOfThePlane) {
  const SyntheticWorld world = world_of_test();
  const RoadObservations seen = SyntheticTrial(world, grid_of_features(), 1).observe(kMotion, 0.0);
  ASSERT_EQ(seen.points.size(), grid_of_features().size());
  EXPECT_NEAR(seen.cam_from_reference[1].translation.norm(), 1.0, 1e-12);
  // In baselines, as the observations are: h / |t|.
  const GroundPlane plane{Eigen::Vector3d::UnitY(), 1.65 / kMotion.translation.norm()};
  const Eigen::Matrix3d homography = homography_of_plane(plane, seen.cam_from_reference[1]);
  for (const RoadPoint& point : seen.points) {
    const auto expected = world.camera->project(homography * *world.camera->ray(point.pixel_in_reference));
    EXPECT_LT((*expected - point.sights[0].pixel).norm(), 1e-9);  // px: rounding
  }
}

TEST(SyntheticTrial, NoiseIsOnTheSecondViewAloneAndHasItsSize) {
  const SyntheticWorld world = world_of_test();
  double squares = 0.0;
  int count = 0;
  for (int seed = 0; seed < 20; ++seed) {
    const SyntheticTrial trial(world, grid_of_features(), static_cast<std::uint64_t>(seed));
    const RoadObservations exact = trial.observe(kMotion, 0.0);
    const RoadObservations noisy = trial.observe(kMotion, 1.5);
    for (std::size_t k = 0; k < exact.scene.size(); ++k) {
      EXPECT_EQ(exact.scene[k].pixel_in_reference, noisy.scene[k].pixel_in_reference);
      squares += (exact.scene[k].pixel_in_view1 - noisy.scene[k].pixel_in_view1).squaredNorm();
      count += 2;
    }
  }
  // Over about 14000 numbers the sd's own sd is 0.6 %.
  EXPECT_NEAR(std::sqrt(squares / count), 1.5, 0.045);
}

TEST(SyntheticTrial, TheSameSeedIsTheSameNoiseScaledWhateverTheMotion) {
  const SyntheticTrial trial(world_of_test(), grid_of_features(), 5);
  const RigidTransform other{Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.0, 0.0, -0.4)};
  const auto noise = [&](const RigidTransform& motion, double noise_px) {
    return Eigen::Vector2d(trial.observe(motion, noise_px).points[7].sights[0].pixel -
                           trial.observe(motion, 0.0).points[7].sights[0].pixel);
  };
  EXPECT_LT((noise(kMotion, 2.0) - 2.0 * noise(other, 1.0)).norm(), 1e-9);  // px: rounding
}

TEST(SyntheticTrial, NothingLiesBeneathTheRoadOrLeavesTheImage) {
  const SyntheticWorld world = world_of_test();
  const RoadObservations seen = SyntheticTrial(world, grid_of_features(), 3).observe(kMotion, 0.0);
  const Eigen::Vector3d centre2 = kMotion.inverse().translation;
  int off_the_road = 0;
  for (const ScenePoint& point : seen.scene) {
    EXPECT_TRUE(world.camera->contains(point.pixel_in_view1));
    // Triangulated by hand: the point of ray 1 that lies nearest to ray 2.
    const Eigen::Vector3d ray1 = *world.camera->ray(point.pixel_in_reference);
    const Eigen::Vector3d ray2 = kMotion.rotation.transpose() * *world.camera->ray(point.pixel_in_view1);
    const double cosine = ray1.dot(ray2);
    const double length = (ray1 - cosine * ray2).dot(centre2) / (1.0 - cosine * cosine);
    EXPECT_LE(length * ray1.y(), 1.65 + 1e-6);
    if (length * ray1.y() < 1.5) ++off_the_road;
  }
  EXPECT_GT(off_the_road, 100);
}

TEST(SyntheticTrial, TheEstimatedMotionIsTheTrueOneWithoutNoiseAndNearItWithNoise) {
  const SyntheticTrial trial(world_of_test(), grid_of_features(), 9);
  MotionOptions options;
  options.max_error_px = 10.0;
  options.loss_px = 4.8;
  const auto direction_error = [&](double noise_px) {
    const RoadObservations seen = trial.observe(kMotion, noise_px);
    Rng rng(4);
    const auto estimated = with_estimated_motion(seen, options, rng);
    EXPECT_TRUE(estimated);
    if (!estimated) return 1.0;
    EXPECT_EQ(estimated->scene.size(), seen.scene.size());  // the threshold refuses nothing
    return (estimated->cam_from_reference[1].translation - seen.cam_from_reference[1].translation).norm();
  };
  EXPECT_LT(direction_error(0.0), 1e-6);
  const double noisy = direction_error(1.0);
  EXPECT_GT(noisy, 1e-5);
  EXPECT_LT(noisy, 2.0 * std::numbers::pi / 180.0);  // of some 400 matches with 1 px: a fraction of a degree
}

}  // namespace
}  // namespace groundscale
