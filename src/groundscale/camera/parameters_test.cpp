#include "groundscale/camera/parameters.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "groundscale/camera/kannala_brandt.hpp"
#include "groundscale/camera/ocam.hpp"
#include "groundscale/camera/pinhole.hpp"

namespace groundscale {
namespace {

const CameraParameter kAll[] = {CameraParameter::kFocal, CameraParameter::kColumn, CameraParameter::kRow,
                                CameraParameter::kRadial};

std::vector<CameraPtr> cameras() {
  return {
      PinholeCamera::create({.fx = 700.0, .fy = 710.0, .cx = 620.0, .cy = 188.0, .k1 = -0.1, .k2 = 0.01}, 1241, 376)
          .value(),
      KannalaBrandtCamera::create({.fx = 340.0, .fy = 342.0, .cx = 640.0, .cy = 400.0, .k1 = -0.02}, 1280, 800).value(),
      OcamCamera::create({.polynomial = {-510.0, 0.0, 4.9e-4, -2.0e-8}, .cx = 961.0, .cy = 538.0}, 1920, 1080).value()};
}

TEST(CameraParameters, WithAValueHasThatValueAndNoOtherChanged) {
  for (const CameraPtr& camera : cameras()) {
    for (const CameraParameter parameter : kAll) {
      const double value = value_of(parameter, *camera) + 2.0 * pixel_step(parameter, *camera);
      const auto changed = with_value(parameter, value, *camera);
      ASSERT_TRUE(changed) << changed.error().message;
      for (const CameraParameter other : kAll) {
        double expected = other == parameter ? value : value_of(other, *camera);
        // A stretched image has its curvature stretched too.
        if (parameter == CameraParameter::kFocal && other == CameraParameter::kRadial && camera->model() == "ocam") {
          expected *= camera->focal_px() / value;
        }
        EXPECT_NEAR(value_of(other, **changed), expected, 1e-9 * std::abs(expected)) << camera->model();
      }
      EXPECT_EQ((*changed)->width(), camera->width());
      EXPECT_EQ((*changed)->model(), camera->model());
    }
  }
}

TEST(CameraParameters, FocalLengthStretchesTheImageAboutThePrincipalPoint) {
  for (const CameraPtr& camera : cameras()) {
    const auto longer = with_value(CameraParameter::kFocal, 1.05 * camera->focal_px(), *camera).value();
    const Eigen::Vector2d centre(value_of(CameraParameter::kColumn, *camera), value_of(CameraParameter::kRow, *camera));
    for (const Eigen::Vector3d& ray : {Eigen::Vector3d(0.4, 0.2, 1.0), Eigen::Vector3d(-0.3, 0.1, 1.0)}) {
      const Eigen::Vector2d from = *camera->project(ray) - centre;
      const Eigen::Vector2d to = *longer->project(ray) - centre;
      EXPECT_LT((to - 1.05 * from).norm(), 1e-6) << camera->model();
    }
  }
}

TEST(CameraParameters, AStepMovesPixelsFarOutByAboutOne) {
  for (const CameraPtr& camera : cameras()) {
    const Eigen::Vector2d corner(camera->width() - 1.0, camera->height() - 1.0);
    const Eigen::Vector3d ray = *camera->ray(corner);
    for (const CameraParameter parameter : kAll) {
      const double value = value_of(parameter, *camera) + pixel_step(parameter, *camera);
      const Eigen::Vector2d moved = *with_value(parameter, value, *camera).value()->project(ray);
      EXPECT_GT((moved - corner).norm(), 0.3) << camera->model() << " " << static_cast<int>(parameter);
      EXPECT_LT((moved - corner).norm(), 2.0) << camera->model() << " " << static_cast<int>(parameter);
    }
  }
}

TEST(CameraParameters, RefusesWhatIsNoCamera) {
  const CameraPtr camera = cameras().front();
  EXPECT_FALSE(with_value(CameraParameter::kFocal, -1.0, *camera));
  EXPECT_FALSE(with_value(CameraParameter::kRadial, -3.0, *camera));
}

TEST(CameraParameters, AreNamedAsInTheFile) {
  const auto all = cameras();
  EXPECT_EQ(file_name_of(CameraParameter::kRadial, *all[0]), "k1");
  EXPECT_EQ(file_name_of(CameraParameter::kRadial, *all[2]), "polynomial[2]");
  EXPECT_EQ(file_name_of(CameraParameter::kRow, *all[1]), "cy");
}

TEST(CameraParameters, TheirStandardDeviationsAreNamedAfterThem) {
  for (const CameraPtr& camera : cameras()) {
    for (const CameraParameter parameter : kAll) {
      const std::string name(file_name_of(parameter, *camera));
      const std::string expected = name == "polynomial[2]" ? "polynomial_2_sd" : name + "_sd";
      EXPECT_EQ(sd_file_name_of(parameter, camera->model()), expected);
    }
  }
}

}  // namespace
}  // namespace groundscale
