#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/plane/methods.hpp"
#include "groundscale/plane/transfer_internal.hpp"

namespace groundscale {
namespace {

const RigidTransform kMotion{exp_so3({0.001, 0.02, -0.001}), Eigen::Vector3d(0.03, 0.01, -1.0).normalized()};
/// 1.65 m over the road with steps of 1 m, looking down by 1 degree.
const GroundPlane kRoad{Eigen::Vector3d(0.01, 1.0, 0.0175).normalized(), 1.65};

CameraPtr camera(double k1 = 0.0) {
  return PinholeCamera::create({.fx = 718.0, .fy = 718.0, .cx = 607.0, .cy = 185.0, .k1 = k1}, 1241, 376).value();
}

/// Points of the road ahead in two views, with noise in the second and a share of points that stand above the road.
RoadObservations road(const CameraPtr& cam, double noise_px, double wrong_share, Rng& rng, int count = 250) {
  RoadObservations observations;
  observations.camera = cam;
  observations.cam_from_reference = {RigidTransform{}, kMotion};
  while (static_cast<int>(observations.points.size()) < count) {
    const Eigen::Vector3d ray(rng.uniform(-0.3, 0.3), rng.uniform(0.08, 0.25), 1.0);
    Eigen::Vector3d point = ray * kRoad.height / kRoad.normal_in_cam.dot(ray);
    if (rng.uniform() < wrong_share) point *= rng.uniform(0.7, 0.9);
    const Eigen::Vector2d noise(rng.normal() * noise_px, rng.normal() * noise_px);
    observations.points.push_back({static_cast<std::int64_t>(observations.points.size()),
                                   *cam->project(point),
                                   {{1, *cam->project(kMotion * point) + noise}}});
  }
  return observations;
}

double tilt_deg(const GroundPlane& plane) {
  return std::acos(std::min(1.0, plane.normal_in_cam.dot(kRoad.normal_in_cam))) * 180.0 / std::numbers::pi;
}

class SparseExact : public testing::TestWithParam<std::tuple<PlaneRefinement, double>> {};

TEST_P(SparseExact, WithoutNoiseThePlaneIsThatOfTheRoad) {
  const auto [refinement, k1] = GetParam();
  Rng rng(1);
  const auto measured = estimate_plane_sparse(road(camera(k1), 0.0, 0.0, rng), {.refinement = refinement}, rng);
  ASSERT_TRUE(measured) << measured.error().message;
  // The simplex ends at a relative size of 1e-7 of its cost.
  const double tolerance = refinement == PlaneRefinement::kNelderMead ? 1e-3 : 1e-6;
  EXPECT_NEAR(measured->plane.height, kRoad.height, tolerance);
  EXPECT_LT(tilt_deg(measured->plane), 50.0 * tolerance);
}
INSTANTIATE_TEST_SUITE_P(RefinementAndDistortion, SparseExact,
                         testing::Combine(testing::Values(PlaneRefinement::kLevenbergMarquardt,
                                                          PlaneRefinement::kNelderMead),
                                          testing::Values(0.0, 0.015, -0.1)));

class SparseNoise : public testing::TestWithParam<double> {};

TEST_P(SparseNoise, HeightErrorStaysWithinFourStandardDeviationsDespiteOutliers) {
  const double noise_px = GetParam();
  Rng rng(2);
  const auto measured = estimate_plane_sparse(road(camera(), noise_px, 0.2, rng), {}, rng);
  ASSERT_TRUE(measured) << measured.error().message;
  const Eigen::Vector3d m = kRoad.inverse_form();
  const Eigen::Vector3d direction = m.normalized();
  const double sd = std::sqrt(direction.dot(measured->covariance_of_m * direction));
  EXPECT_LT(std::abs(measured->plane.inverse_form().norm() - m.norm()), 4.0 * sd);
  EXPECT_LT(sd / m.norm(), 0.05 * noise_px + 1e-6);
}
INSTANTIATE_TEST_SUITE_P(Pixels, SparseNoise, testing::Values(0.05, 0.1, 0.2));

TEST(Sparse, MoreViewsGiveABetterPlane) {
  double two_views = 0.0;
  double four_views = 0.0;
  for (int seed = 0; seed < 20; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    RoadObservations observations = road(camera(), 0.15, 0.0, rng);
    const auto two = estimate_plane_sparse(observations, {}, rng);
    for (int view = 2; view < 4; ++view) {
      const RigidTransform pose{kMotion.rotation, 0.5 * view * kMotion.translation};
      observations.cam_from_reference.push_back(pose);
      for (RoadPoint& point : observations.points) {
        const Eigen::Vector3d ray = *camera()->ray(point.pixel_in_reference);
        const auto pixel = camera()->project(pose * (ray * kRoad.height / kRoad.normal_in_cam.dot(ray)));
        point.sights.push_back({view, *pixel + 0.15 * Eigen::Vector2d(rng.normal(), rng.normal())});
      }
    }
    const auto four = estimate_plane_sparse(observations, {}, rng);
    ASSERT_TRUE(two && four);
    two_views += std::pow(two->plane.height - kRoad.height, 2);
    four_views += std::pow(four->plane.height - kRoad.height, 2);
  }
  EXPECT_LT(four_views, 0.5 * two_views);  // 3 sights instead of 1, of which one has 1.5 times the baseline
}

TEST(Sparse, RefusesTooFewPointsAndAViewWithoutBaseline) {
  Rng rng(3);
  RoadObservations few = road(camera(), 0.0, 0.0, rng, 20);
  const auto refused = estimate_plane_sparse(few, {}, rng);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kTooFewMatches);

  RoadObservations standing = road(camera(), 0.0, 0.0, rng);
  standing.cam_from_reference[1] = {};
  for (RoadPoint& point : standing.points) point.sights[0].pixel = point.pixel_in_reference;
  EXPECT_FALSE(estimate_plane_sparse(standing, {}, rng));
}

TEST(TransferError, DerivativesAgreeWithFiniteDifferences) {
  Rng rng(4);
  const CameraPtr cam = camera(0.02);
  const RoadObservations observations = road(cam, 1.0, 0.0, rng, 10);
  const Eigen::Vector3d m = kRoad.inverse_form() * 1.03;
  constexpr double kStep = 1e-6;
  for (const Transfer& transfer : transfers_of(observations)) {
    const auto error = transfer_error(*cam, kMotion, m, transfer);
    ASSERT_TRUE(error);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
      const auto plus = transfer_error(*cam, kMotion, m + step, transfer);
      const auto minus = transfer_error(*cam, kMotion, m - step, transfer);
      EXPECT_LT(((plus->forward - minus->forward) / (2.0 * kStep) - error->forward_by_m.col(k)).norm(), 1e-4);
      EXPECT_LT(((plus->backward - minus->backward) / (2.0 * kStep) - error->backward_by_m.col(k)).norm(), 1e-4);
    }
    const auto by_motion = forward_by_motion(*cam, kMotion, m, transfer);
    ASSERT_TRUE(by_motion);
    const Eigen::Matrix<double, 3, 2> tangents = tangents_of(kMotion.translation);
    for (int k = 0; k < 5; ++k) {
      const auto moved = [&](double step) {
        RigidTransform pose = kMotion;
        if (k < 3) pose.rotation = exp_so3(step * Eigen::Vector3d::Unit(k)) * pose.rotation;
        if (k >= 3) pose.translation += step * tangents.col(k - 3);
        return transfer_error(*cam, pose, m, transfer)->forward;
      };
      EXPECT_LT(((moved(kStep) - moved(-kStep)) / (2.0 * kStep) - by_motion->col(k)).norm(), 1e-4);
    }
  }
}

}  // namespace
}  // namespace groundscale
