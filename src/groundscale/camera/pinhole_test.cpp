#include "groundscale/camera/pinhole.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace groundscale {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 1241;
constexpr int kHeight = 376;
const PinholeParameters kIdeal{.fx = 718.856, .fy = 718.856, .cx = 607.1928, .cy = 185.2157};

PinholeParameters distorted_by(double k1, double k2, double p1, double p2, double k3) {
  PinholeParameters parameters = kIdeal;
  parameters.fy = 702.5;
  parameters.k1 = k1;
  parameters.k2 = k2;
  parameters.p1 = p1;
  parameters.p2 = p2;
  parameters.k3 = k3;
  return parameters;
}

CameraPtr camera_of(const PinholeParameters& parameters) {
  return PinholeCamera::create(parameters, kWidth, kHeight).value();
}

TEST(PinholeCamera, ProjectsAsItsEquationWorkedOutByHand) {
  // (x, y) = (0.5, -0.25), r^2 = 0.3125; radial = 1 + 0.1 r^2 - 0.2 r^4 + 0.3 r^6 = 1.0208740234375
  // x_d = 0.5 radial + 2 (0.01) x y + 0.02 (r^2 + 2 x^2) = 0.51043701171875 - 0.0025 + 0.01625 = 0.52418701171875
  // y_d = -0.25 radial + 0.01 (r^2 + 2 y^2) + 2 (0.02) x y = -0.255218505859375 + 0.004375 - 0.005
  const PinholeParameters parameters{
      .fx = 100.0, .fy = 200.0, .cx = 50.0, .cy = 60.0, .k1 = 0.1, .k2 = -0.2, .p1 = 0.01, .p2 = 0.02, .k3 = 0.3};
  const auto camera = PinholeCamera::create(parameters, 100, 120);
  ASSERT_TRUE(camera);
  const auto pixel = (*camera)->project(Eigen::Vector3d(1.0, -0.5, 2.0));
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 100.0 * 0.52418701171875 + 50.0, 1e-12);
  EXPECT_NEAR(pixel->y(), 200.0 * -0.255843505859375 + 60.0, 1e-12);
}

TEST(PinholeCamera, TheOpticalAxisMeetsThePrincipalPoint) {
  for (const PinholeParameters& parameters : {kIdeal, distorted_by(-0.1, 0.01, 1e-3, -2e-3, 0.0)}) {
    const CameraPtr camera = camera_of(parameters);
    EXPECT_EQ(camera->project(Eigen::Vector3d(0.0, 0.0, 3.0)), Eigen::Vector2d(parameters.cx, parameters.cy));
    EXPECT_LT((*camera->ray({parameters.cx, parameters.cy}) - Eigen::Vector3d::UnitZ()).norm(), 1e-15);
  }
}

class PinholeDistortion : public testing::TestWithParam<PinholeParameters> {};

TEST_P(PinholeDistortion, PixelToRayAndBackIsWithinAMillionthOfAPixel) {
  const CameraPtr camera = camera_of(GetParam());
  for (double y = 0.0; y < kHeight; y += 15.0) {
    for (double x = 0.0; x < kWidth; x += 20.0) {
      const auto ray = camera->ray({x, y});
      ASSERT_TRUE(ray) << x << " " << y;
      EXPECT_NEAR(ray->norm(), 1.0, 1e-15);
      const auto pixel = camera->project(*ray);
      ASSERT_TRUE(pixel) << x << " " << y;
      EXPECT_LT((*pixel - Eigen::Vector2d(x, y)).norm(), 1e-6);
    }
  }
}

TEST_P(PinholeDistortion, RayToPixelAndBackIsTheSameDirectionWhateverTheLength) {
  const CameraPtr camera = camera_of(GetParam());
  for (const Eigen::Vector3d& ray : {Eigen::Vector3d(0.3, -0.1, 1.0), Eigen::Vector3d(-4.0, 1.0, 8.0)}) {
    const auto back = camera->ray(*camera->project(ray));
    ASSERT_TRUE(back);
    EXPECT_LT((*back - ray.normalized()).norm(), 1e-9);  // 1e-6 px over a focal length of 700 px
  }
}

TEST_P(PinholeDistortion, TheJacobianIsTheCentralDifference) {
  const CameraPtr camera = camera_of(GetParam());
  for (const Eigen::Vector3d& ray : {Eigen::Vector3d(0.0, 0.0, 1.0), Eigen::Vector3d(0.4, 0.15, 1.0),
                                     Eigen::Vector3d(-1.2, 0.3, 2.0), Eigen::Vector3d(0.05, -0.02, 0.1)}) {
    Eigen::Matrix<double, 2, 3> analytic;
    const auto pixel = camera->project(ray, &analytic);
    ASSERT_TRUE(pixel);
    EXPECT_EQ(*pixel, *camera->project(ray));
    const double step = 1e-5 * ray.z();
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d shift = step * Eigen::Vector3d::Unit(k);
      const Eigen::Vector2d numeric = (*camera->project(ray + shift) - *camera->project(ray - shift)) / (2.0 * step);
      // Second order of the step against entries of focal / z, third derivatives of a few times that.
      EXPECT_LT((analytic.col(k) - numeric).norm(), 1e-7 * 700.0 / ray.z()) << ray.transpose() << ", column " << k;
    }
    // The pixel depends on the direction alone.
    EXPECT_LT((analytic * ray).norm(), 1e-10);
  }
}

INSTANTIATE_TEST_SUITE_P(Distortions, PinholeDistortion,
                         testing::Values(kIdeal, distorted_by(0.0, 0.0, 0.0, 0.0, 0.0),
                                         distorted_by(0.0117, 0.0, 0.0, 0.0, 0.0),     // rest of a rectified image
                                         distorted_by(-0.25, 0.1, 9e-4, 2e-3, -0.02),  // a dashcam's barrel
                                         distorted_by(0.2, 0.1, -1e-3, 1e-3, 0.05)));  // pincushion

TEST(PinholeCamera, NothingIsSeenBehindOrBesideIt) {
  for (const PinholeParameters& parameters : {kIdeal, distorted_by(0.1, 0.0, 0.0, 0.0, 0.0)}) {
    const CameraPtr camera = camera_of(parameters);
    Eigen::Matrix<double, 2, 3> jacobian;
    EXPECT_FALSE(camera->project(Eigen::Vector3d(0.1, 0.1, -1.0)));
    EXPECT_FALSE(camera->project(Eigen::Vector3d(1.0, 0.0, 0.0)));
    EXPECT_FALSE(camera->project(Eigen::Vector3d::Zero()));
    EXPECT_FALSE(camera->project(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN())));
    EXPECT_FALSE(camera->project(Eigen::Vector3d(0.1, 0.1, -1.0), &jacobian));
  }
}

TEST(PinholeCamera, BeyondWhereTheDistortionFoldsBackThereIsNoPixelAndNoRay) {
  // r (1 - 0.1 r^2) grows up to r = sqrt(1 / 0.3) = 1.826, where it is 1.217.
  const PinholeParameters parameters = distorted_by(-0.1, 0.0, 0.0, 0.0, 0.0);
  const CameraPtr camera = camera_of(parameters);
  EXPECT_TRUE(camera->project(Eigen::Vector3d(1.8, 0.0, 1.0)));
  EXPECT_FALSE(camera->project(Eigen::Vector3d(1.85, 0.0, 1.0)));
  // This ray would fall into the middle of the image by the equation alone: 3 (1 - 0.9) = 0.3.
  EXPECT_FALSE(camera->project(Eigen::Vector3d(3.0, 0.0, 1.0)));
  EXPECT_TRUE(camera->ray({parameters.cx + 1.2 * parameters.fx, parameters.cy}));
  EXPECT_FALSE(camera->ray({parameters.cx + 1.25 * parameters.fx, parameters.cy}));
}

TEST(PinholeCamera, ADistortionThatFoldsInsideTheImageIsRefused) {
  // r (1 - 0.3 r^2) is at most 0.703; the image's left side lies at 0.845.
  const auto camera = PinholeCamera::create(distorted_by(-0.3, 0.0, 0.0, 0.0, 0.0), kWidth, kHeight);
  ASSERT_FALSE(camera);
  EXPECT_EQ(camera.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(camera.error().message, HasSubstr("folds back inside the image"));
}

TEST(PinholeCamera, NumbersThatMakeNoCameraAreRefusedByName) {
  PinholeParameters no_focal = kIdeal, negative = kIdeal, not_a_number = kIdeal, infinite = kIdeal;
  no_focal.fx = 0.0;
  negative.fy = -700.0;
  not_a_number.cy = std::numeric_limits<double>::quiet_NaN();
  infinite.k2 = std::numeric_limits<double>::infinity();
  for (const auto& [parameters, name] : {std::pair(no_focal, "fx is 0"), std::pair(negative, "fy is -700"),
                                         std::pair(not_a_number, "cy is nan"), std::pair(infinite, "k2 is inf")}) {
    const auto camera = PinholeCamera::create(parameters, kWidth, kHeight);
    ASSERT_FALSE(camera) << name;
    EXPECT_EQ(camera.error().code, ErrorCode::kBadInput);
    EXPECT_THAT(camera.error().message, HasSubstr(name));
  }
  EXPECT_FALSE(PinholeCamera::create(kIdeal, 0, kHeight));
  EXPECT_FALSE(PinholeCamera::create(kIdeal, kWidth, -1));
}

TEST(PinholeCamera, ContainsPixelsUpToTheOuterEdgeOfTheLastOne) {
  const CameraPtr camera = camera_of(kIdeal);
  EXPECT_TRUE(camera->contains({-0.5, -0.5}));
  EXPECT_TRUE(camera->contains({kWidth - 0.6, kHeight - 0.6}));
  EXPECT_FALSE(camera->contains({-0.6, 10.0}));
  EXPECT_FALSE(camera->contains({kWidth - 0.5, 10.0}));
  EXPECT_FALSE(camera->contains({10.0, kHeight - 0.5}));
}

}  // namespace
}  // namespace groundscale
