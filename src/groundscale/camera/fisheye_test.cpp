// What every fisheye model has to hold, and each one's equation worked out by hand.
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/camera/kannala_brandt.hpp"
#include "groundscale/camera/ocam.hpp"

namespace groundscale {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 960;
constexpr int kHeight = 540;
constexpr double kDegree = std::numbers::pi / 180.0;

const KannalaBrandtParameters kKannalaBrandt{
    .fx = 300.0, .fy = 295.0, .cx = 470.0, .cy = 275.0, .k1 = 0.05, .k2 = -0.01, .k3 = 0.002, .k4 = -0.0003};
const OcamParameters kOcam{
    .polynomial = {-300.0, 0.0, 1.1e-3, -2e-7, 1.2e-9}, .cx = 470.0, .cy = 275.0, .c = 1.001, .d = 2e-4, .e = -3e-4};

CameraPtr kannala_brandt(const KannalaBrandtParameters& parameters = kKannalaBrandt) {
  return KannalaBrandtCamera::create(parameters, kWidth, kHeight).value();
}
CameraPtr ocam(const OcamParameters& parameters = kOcam) {
  return OcamCamera::create(parameters, kWidth, kHeight).value();
}

Eigen::Vector3d ray_at(double angle, double around) {
  return {std::sin(angle) * std::cos(around), std::sin(angle) * std::sin(around), std::cos(angle)};
}

struct Model {
  const char* name;
  CameraPtr camera;
  double max_angle_rad;
};

std::ostream& operator<<(std::ostream& stream, const Model& model) { return stream << model.name; }

std::vector<Model> models() {
  std::vector<Model> all;
  KannalaBrandtParameters ideal = kKannalaBrandt;
  ideal.k1 = ideal.k2 = ideal.k3 = ideal.k4 = 0.0;
  for (const auto& [name, parameters] :
       {std::pair("kannala_brandt", kKannalaBrandt), std::pair("equidistant", ideal)}) {
    const CameraPtr camera = kannala_brandt(parameters);
    all.push_back({name, camera, dynamic_cast<const KannalaBrandtCamera&>(*camera).max_angle_rad()});
  }
  const CameraPtr camera = ocam();
  all.push_back({"ocam", camera, dynamic_cast<const OcamCamera&>(*camera).max_angle_rad()});
  return all;
}

class Fisheye : public testing::TestWithParam<Model> {};

TEST_P(Fisheye, PixelToRayAndBackIsWithinAMillionthOfAPixel) {
  const Camera& camera = *GetParam().camera;
  for (double y = -20.0; y < kHeight + 20.0; y += 14.0) {
    for (double x = -20.0; x < kWidth + 20.0; x += 20.0) {
      const auto ray = camera.ray({x, y});
      ASSERT_TRUE(ray) << x << " " << y;
      EXPECT_NEAR(ray->norm(), 1.0, 1e-14);
      const auto pixel = camera.project(*ray);
      ASSERT_TRUE(pixel) << x << " " << y;
      EXPECT_LT((*pixel - Eigen::Vector2d(x, y)).norm(), 1e-6);
    }
  }
}

TEST_P(Fisheye, RayToPixelAndBackIsTheSameDirectionUpToTheLastAngle) {
  const Camera& camera = *GetParam().camera;
  for (const double share : {1e-12, 1e-5, 0.1, 0.5, 0.8, 0.99}) {
    for (double around = 0.1; around < 6.3; around += 0.7) {
      const Eigen::Vector3d ray = ray_at(share * GetParam().max_angle_rad, around);
      const auto pixel = camera.project(7.0 * ray);
      ASSERT_TRUE(pixel) << share;
      const auto back = camera.ray(*pixel);
      ASSERT_TRUE(back) << share;
      // 1e-6 px, where a pixel is worth at most a hundredth of what it is in the middle.
      EXPECT_LT((*back - ray).norm(), 1e-7) << share << " " << around;
    }
  }
}

TEST_P(Fisheye, JacobianAgreesWithDifferences) {
  const Camera& camera = *GetParam().camera;
  constexpr double kStep = 1e-6;
  for (const double angle : {0.0, 1e-7, 0.3, 1.0, 1.5, 1.7}) {
    if (angle + 0.01 > GetParam().max_angle_rad) continue;
    for (const double length : {0.5, 12.0}) {
      const Eigen::Vector3d ray = length * ray_at(angle, 0.7);
      Eigen::Matrix<double, 2, 3> jacobian;
      ASSERT_EQ(*camera.project(ray, &jacobian), *camera.project(ray));
      Eigen::Matrix<double, 2, 3> differences;
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d step = kStep * length * Eigen::Vector3d::Unit(k);
        differences.col(k) = (*camera.project(ray + step) - *camera.project(ray - step)) / (2.0 * kStep * length);
      }
      // Central differences err by the third derivative (1e-12 f) and by rounding (1e-13 px / 1e-6).
      EXPECT_LT((jacobian - differences).norm() * length, 1e-6 * camera.focal_px()) << angle << " " << length;
    }
  }
}

TEST_P(Fisheye, OutsideTheValidFieldThereIsNoAnswer) {
  const Camera& camera = *GetParam().camera;
  EXPECT_FALSE(camera.project({0.0, 0.0, -1.0}));
  EXPECT_FALSE(camera.project({0.0, 0.0, 0.0}));
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(camera.project({kNan, 0.0, 1.0}));
  EXPECT_FALSE(camera.ray({kNan, 0.0}));
  EXPECT_FALSE(camera.ray({1e6, 0.0}));
  if (GetParam().max_angle_rad < 3.1) {
    EXPECT_FALSE(camera.project(ray_at(GetParam().max_angle_rad + 0.01, 1.0)));
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Fisheye, testing::ValuesIn(models()));

TEST(KannalaBrandtCamera, ProjectsAsItsEquationWorkedOutByHand) {
  // theta = 0.5: theta_d = 0.5 (1 + 0.1/4 - 0.2/16 + 0.3/64 - 0.4/256) = 0.5 * 1.015625
  const KannalaBrandtParameters parameters{
      .fx = 100.0, .fy = 200.0, .cx = 50.0, .cy = 60.0, .k1 = 0.1, .k2 = -0.2, .k3 = 0.3, .k4 = -0.4};
  const CameraPtr camera = KannalaBrandtCamera::create(parameters, 100, 120).value();
  const auto right = camera->project(3.0 * ray_at(0.5, 0.0));
  EXPECT_NEAR(right->x(), 50.0 + 100.0 * 0.5078125, 1e-12);
  EXPECT_NEAR(right->y(), 60.0, 1e-12);
  const auto down = camera->project(ray_at(0.5, 90.0 * kDegree));
  EXPECT_NEAR(down->x(), 50.0, 1e-12);
  EXPECT_NEAR(down->y(), 60.0 + 200.0 * 0.5078125, 1e-12);
}

TEST(KannalaBrandtCamera, SeesBackwardsWhereTheModelDoes) {
  KannalaBrandtParameters ideal = kKannalaBrandt;
  ideal.k1 = ideal.k2 = ideal.k3 = ideal.k4 = 0.0;
  const auto pixel = kannala_brandt(ideal)->project(ray_at(100.0 * kDegree, 0.0));
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 470.0 + 300.0 * 100.0 * kDegree, 1e-9);
}

TEST(KannalaBrandtCamera, RefusesWhatCanNotBe) {
  const auto message_of = [](const KannalaBrandtParameters& parameters, int width = kWidth) {
    const auto camera = KannalaBrandtCamera::create(parameters, width, kHeight);
    return camera ? std::string("taken") : camera.error().message;
  };
  KannalaBrandtParameters parameters = kKannalaBrandt;
  EXPECT_THAT(message_of(parameters, 0), HasSubstr("image size is 0x540"));
  parameters.fy = -1.0;
  EXPECT_THAT(message_of(parameters), HasSubstr("fy is -1, a focal length must be above 0"));
  parameters = kKannalaBrandt;
  parameters.k3 = std::numeric_limits<double>::infinity();
  EXPECT_THAT(message_of(parameters), HasSubstr("k3 is inf, it must be a finite number"));
  parameters = kKannalaBrandt;
  parameters.k1 = -3.0;  // folds back at a third of a radian, 63 px from the middle
  EXPECT_THAT(message_of(parameters), HasSubstr("folds back inside the image: beyond 19."));
}

TEST(OcamCamera, ProjectsAsItsEquationWorkedOutByHand) {
  // F = 100 everywhere, a pinhole: (x, y) = (50, -25); col = 50 + 0.2 (-25) = 45, row = 0.1 (50) + 2 (-25) = -45.
  const CameraPtr camera = ocam({.polynomial = {-100.0}, .cx = 300.0, .cy = 200.0, .c = 2.0, .d = 0.1, .e = 0.2});
  const auto pixel = camera->project({0.5, -0.25, 1.0});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 345.0, 1e-9);
  EXPECT_NEAR(pixel->y(), 155.0, 1e-9);
}

TEST(OcamCamera, WithTheSeriesOfAnEquidistantLensIsOne) {
  // rho = f theta has F = rho / tan(rho / f) = f - rho^2 / (3 f) - rho^4 / (45 f^3) - 2 rho^6 / (945 f^5) - ...
  constexpr double kFocal = 400.0;
  const CameraPtr camera =
      ocam({.polynomial = {-kFocal, 0.0, 1.0 / (3.0 * kFocal), 0.0, 1.0 / (45.0 * std::pow(kFocal, 3))},
            .cx = 480.0,
            .cy = 270.0});
  for (const double angle : {0.1, 0.3, 0.5}) {
    const auto pixel = camera->project(ray_at(angle, 0.0));
    ASSERT_TRUE(pixel);
    // The terms left out are 3.4e-5 f at 0.5 rad, a hundredth of a pixel.
    EXPECT_NEAR(pixel->x(), 480.0 + kFocal * angle, 0.02);
    EXPECT_NEAR(pixel->y(), 270.0, 1e-9);
  }
}

TEST(OcamCamera, RefusesWhatCanNotBe) {
  const auto message_of = [](const OcamParameters& parameters, int height = kHeight) {
    const auto camera = OcamCamera::create(parameters, kWidth, height);
    return camera ? std::string("taken") : camera.error().message;
  };
  OcamParameters parameters = kOcam;
  EXPECT_THAT(message_of(parameters, -1), HasSubstr("image size is 960x-1"));
  parameters.polynomial = {};
  EXPECT_THAT(message_of(parameters), HasSubstr("no coefficients"));
  parameters.polynomial = {300.0};
  EXPECT_THAT(message_of(parameters), HasSubstr("begins with 300, it must be negative"));
  parameters = kOcam;
  parameters.cx = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(message_of(parameters), HasSubstr("cx is nan"));
  parameters = kOcam;
  parameters.c = 0.0;
  EXPECT_THAT(message_of(parameters), HasSubstr("can't be undone"));
  parameters = kOcam;
  // F - rho F' is 0.1 everywhere: less than a hundredth of the ray from 1 px on, and the image's centre is 11 px away.
  parameters.polynomial = {-0.1, 10.0};
  EXPECT_THAT(message_of(parameters), HasSubstr("folds back inside the image"));
}

}  // namespace
}  // namespace groundscale
