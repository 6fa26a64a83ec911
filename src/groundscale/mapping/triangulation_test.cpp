#include "groundscale/mapping/triangulation.hpp"

#include <cmath>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "groundscale/mapping/test_street_internal.hpp"

namespace groundscale {
namespace {

constexpr int kViews = 6;

/// A point seen from a street's views, a metre apart; empty where it leaves the image.
std::vector<Sight> sights_of(const Eigen::Vector3d& point, const Camera& camera, double noise_px, Rng& rng,
                             const Eigen::Vector3d& origin = Eigen::Vector3d::Zero()) {
  std::vector<Sight> sights;
  for (int v = 0; v < kViews; ++v) {
    const RigidTransform world_from_cam{exp_so3({0.0, 0.01 * v, 0.0}),
                                        origin + Eigen::Vector3d(0.05 * v, 0.0, 0.8 * v)};
    const RigidTransform cam_from_world = world_from_cam.inverse();
    const auto pixel = camera.project(cam_from_world * (origin + point));
    if (!pixel || !camera.contains(*pixel)) return {};
    const Eigen::Vector2d noisy = *pixel + noise_px * normal2(rng);
    const auto ray = camera.ray(noisy);
    if (!ray) return {};
    sights.push_back({cam_from_world, *ray, noisy});
  }
  return sights;
}

class TriangulationOf : public testing::TestWithParam<TestCamera> {
 protected:
  const CameraPtr camera_ = test_camera(GetParam());
};

TEST_P(TriangulationOf, IsExactWithoutNoise) {
  Rng rng(1);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3d point = street_point(*camera_, rng);
    const auto sights = sights_of(point, *camera_, 0.0, rng);
    if (sights.empty()) continue;
    const auto found = triangulate(sights, *camera_, {.min_parallax_rad = 0.0});
    ASSERT_TRUE(found);
    // Rounding of 1e-13 px over the smallest parallax squared.
    EXPECT_LT((found->point_in_world - point).norm(), 1e-6);
    EXPECT_LT(found->rms_px, 1e-7);
  }
}

TEST_P(TriangulationOf, ItsCovarianceIsThatOfItsErrors) {
  Rng rng(2);
  constexpr double kNoisePx = 0.1;
  double squares = 0.0;
  int count = 0;
  for (int k = 0; k < 4000; ++k) {
    const Eigen::Vector3d point = street_point(*camera_, rng);
    const auto sights = sights_of(point, *camera_, kNoisePx, rng);
    if (sights.empty()) continue;
    const auto found = triangulate(sights, *camera_, {.min_parallax_rad = 0.03});
    if (!found) continue;
    const Eigen::Vector3d error = found->point_in_world - point;
    squares += error.dot(found->covariance.inverse() * error) / (kNoisePx * kNoisePx);
    ++count;
  }
  ASSERT_GT(count, 500);
  // Chi-square of 3 degrees of freedom has variance 6; four sd of the mean, and 3 % for what the loss and the
  // linearisation cost.
  EXPECT_NEAR(squares / count, 3.0, 4.0 * std::sqrt(6.0 / count) + 0.09);
}

TEST_P(TriangulationOf, NoPointBesideItFitsBetter) {
  Rng rng(3);
  int count = 0;
  while (count < 50) {
    const auto sights = sights_of(street_point(*camera_, rng), *camera_, 0.5, rng);
    if (sights.empty()) continue;
    const auto found = triangulate(sights, *camera_, {.max_iterations = 30, .min_parallax_rad = 0.01});
    if (!found) continue;
    ++count;
    const auto cost = [&](const Eigen::Vector3d& point) {
      double sum = 0.0;
      for (const Sight& sight : sights) {
        const auto pixel = camera_->project(sight.cam_from_world * point);
        sum += std::log1p((*pixel - sight.pixel).squaredNorm());
      }
      return sum;
    };
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector3d beside = found->point_in_world + 1e-3 * found->point_in_world.norm() * normal3(rng);
      EXPECT_GT(cost(beside), cost(found->point_in_world));
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Cameras, TriangulationOf,
                         testing::Values(TestCamera::kPinhole, TestCamera::kDistorted, TestCamera::kFisheye));

TEST(Triangulation, ErrorStaysProportionalToTheNoise) {
  const CameraPtr camera = test_camera(TestCamera::kPinhole);
  const Eigen::Vector3d point(4.0, 1.0, 15.0);
  for (const double noise_px : {0.1, 0.3, 1.0}) {
    Rng rng(4);
    double squares = 0.0;
    constexpr int kTrials = 200;
    for (int k = 0; k < kTrials; ++k) {
      const auto found = triangulate(sights_of(point, *camera, noise_px, rng), *camera);
      ASSERT_TRUE(found);
      squares += (found->point_in_world - point).squaredNorm();
    }
    // The directions spread by 0.026 rad (0.075 rad over six views): range sd_px / (f 0.026 sqrt(6)) = 0.3 m a pixel;
    // 200 trials scatter by 5 %, four of those.
    EXPECT_LT(std::sqrt(squares / kTrials), 0.36 * noise_px);
  }
}

TEST(Triangulation, OneWrongSightOfSixCostsLittle) {
  const CameraPtr camera = test_camera(TestCamera::kPinhole);
  Rng rng(5);
  const Eigen::Vector3d point(4.0, 1.0, 15.0);
  for (std::size_t wrong = 0; wrong < kViews; ++wrong) {
    auto sights = sights_of(point, *camera, 0.1, rng);
    sights[wrong].pixel += Eigen::Vector2d(15.0, -10.0);
    sights[wrong].ray = camera->ray(sights[wrong].pixel).value();
    const auto found = triangulate(sights, *camera, {.max_iterations = 15});
    ASSERT_TRUE(found) << wrong;
    // Four sd of the five others' at 0.1 px.
    EXPECT_LT((found->point_in_world - point).norm(), 0.1) << wrong;
    EXPECT_GT(found->rms_px, 5.0);
  }
}

TEST(Triangulation, TellsTheParallax) {
  const CameraPtr camera = test_camera(TestCamera::kPinhole);
  std::vector<Sight> sights;
  for (const double x : {-1.0, 0.0, 1.0}) {
    const RigidTransform cam_from_world{Eigen::Matrix3d::Identity(), {-x, 0.0, 0.0}};
    const Eigen::Vector2d pixel = camera->project(cam_from_world * Eigen::Vector3d(0.0, 0.0, 10.0)).value();
    sights.push_back({cam_from_world, camera->ray(pixel).value(), pixel});
  }
  const auto found = triangulate(sights, *camera);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->parallax_rad, 2.0 * std::atan(0.1), 1e-12);
}

TEST(Triangulation, FarFromTheOriginOfTheWorldItIsAsGood) {
  const CameraPtr camera = test_camera(TestCamera::kPinhole);
  Rng rng(6);
  const Eigen::Vector3d origin(3000.0, -20.0, 8000.0);
  const Eigen::Vector3d point(4.0, 1.0, 15.0);
  const auto found = triangulate(sights_of(point, *camera, 0.0, rng, origin), *camera);
  ASSERT_TRUE(found);
  EXPECT_LT((found->point_in_world - origin - point).norm(), 1e-7);
}

TEST(Triangulation, NothingComesOfParallelRays) {
  const CameraPtr camera = test_camera(TestCamera::kPinhole);
  const Eigen::Vector2d pixel(700.0, 200.0);
  const Eigen::Vector3d ray = camera->ray(pixel).value();
  const RigidTransform beside{Eigen::Matrix3d::Identity(), {-1.0, 0.0, 0.0}};
  EXPECT_FALSE(triangulate(std::vector<Sight>{{{}, ray, pixel}, {beside, ray, pixel}}, *camera));
  // Nor of views from one place.
  EXPECT_FALSE(triangulate(std::vector<Sight>{{{}, ray, pixel}, {{}, ray, pixel}}, *camera));
}

TEST(Triangulation, NothingComesOfRaysThatMeetBehindTheCameras) {
  for (const TestCamera kind : {TestCamera::kPinhole, TestCamera::kFisheye}) {
    const CameraPtr camera = test_camera(kind);
    const RigidTransform beside{Eigen::Matrix3d::Identity(),
                                {-1.0, 0.0, 0.0}};  // to the right, and looks further right
    const Eigen::Vector2d left(600.0, 200.0);
    const Eigen::Vector2d right(700.0, 200.0);
    EXPECT_FALSE(triangulate(
        std::vector<Sight>{{{}, camera->ray(left).value(), left}, {beside, camera->ray(right).value(), right}},
        *camera));
    EXPECT_TRUE(triangulate(
        std::vector<Sight>{{{}, camera->ray(right).value(), right}, {beside, camera->ray(left).value(), left}},
        *camera));
  }
}

TEST(Triangulation, NothingComesOfFewerThanTwoSights) {
  const CameraPtr camera = test_camera(TestCamera::kPinhole);
  EXPECT_FALSE(triangulate({}, *camera));
  EXPECT_FALSE(triangulate(std::vector<Sight>{{{}, Eigen::Vector3d::UnitZ(), {620.0, 188.0}}}, *camera));
}

TEST(Triangulation, DefaultsAreInTheirRanges) { EXPECT_TRUE(check_ranges(TriangulationOptions{})); }

}  // namespace
}  // namespace groundscale
