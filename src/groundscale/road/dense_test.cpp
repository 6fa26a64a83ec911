#include "groundscale/road/dense.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <tuple>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/geometry/so3.hpp"
#include "groundscale/road/road_alignment_internal.hpp"
#include "groundscale/road/test_road_images_internal.hpp"

namespace groundscale {
namespace {

using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180.0;

CameraPtr pinhole() {
  return PinholeCamera::create({.fx = 360.0, .fy = 360.0, .cx = 319.5, .cy = 79.5, .k1 = 0.01}, 640, 200).value();
}
CameraPtr fisheye() {
  return KannalaBrandtCamera::create({.fx = 220.0, .fy = 220.0, .cx = 319.5, .cy = 119.5, .k1 = -0.02, .k2 = 0.003},
                                     640, 320)
      .value();
}

TestRoadImages road(const CameraPtr& camera) {
  return {.camera = camera,
          .motion = {exp_so3({0.001, 0.02, -0.001}), Eigen::Vector3d(0.03, 0.01, -1.0).normalized()},
          .road = {Eigen::Vector3d(0.01, 1.0, 0.0175).normalized(), 1.65}};
}

double tilt_deg(const GroundPlane& a, const GroundPlane& b) {
  return std::atan2(a.normal_in_cam.cross(b.normal_in_cam).norm(), a.normal_in_cam.dot(b.normal_in_cam)) / kDegree;
}

GroundPlane changed(const GroundPlane& plane, double pitch_deg, double height_factor) {
  return {exp_so3({pitch_deg * kDegree, 0.0, 0.0}) * plane.normal_in_cam, height_factor * plane.height};
}

/// No method of pixels is exact: grey levels are rounded (0.3 of a level each), and between pixels they are taken as
/// linear. Over thousands of pixels that is a few thousandths of a pixel, and a pixel is about 10 % of the height at a
/// flow of 10 px.
constexpr double kHeightBound = 0.002;  // relative
constexpr double kTiltBoundDeg = 0.07;

struct Method {
  const char* name;
  Result<PlaneMeasurement> (*estimate)(const RoadObservations&, const PlaneOptions&, Rng&);
  DenseRefinement refinement = DenseRefinement::kGaussNewton;
};

class DenseExact : public testing::TestWithParam<std::tuple<Method, bool>> {};

TEST_P(DenseExact, RenderedRoadHasItsPlaneUpToInterpolation) {
  const auto& [method, wide] = GetParam();
  const TestRoadImages images = road(wide ? fisheye() : pinhole());
  RoadObservations observations = images.observations();
  observations.predicted_plane = changed(images.road, 0.5, 1.04);
  observations.expected_normal = images.road.normal_in_cam;
  PlaneOptions options;
  options.dense.refinement = method.refinement;
  Rng rng(1);
  const auto measured = method.estimate(observations, options, rng);
  ASSERT_TRUE(measured) << measured.error().message;
  // With the motion free as well, a turn and a tilt of the road look nearly the same; the simplex stops a little early.
  const double slack = std::string(method.name) == "joint_dense" ? 5.0
                       : std::string(method.name) == "score"     ? 1.5
                                                                 : 1.0;
  EXPECT_NEAR(measured->plane.height / images.road.height, 1.0, slack * kHeightBound);
  EXPECT_LT(tilt_deg(measured->plane, images.road), slack * kTiltBoundDeg);
  if (measured->motion) {
    const Eigen::Matrix3d turn = measured->motion->rotation * images.motion.rotation.transpose();
    // A turn of 0.002 moves the region as a direction that is off by 0.01 does, to a tenth of a pixel.
    EXPECT_LT(rotation_angle(turn), 0.002);
    EXPECT_LT((measured->motion->translation - images.motion.translation).norm(), 0.01);
  }
}
INSTANTIATE_TEST_SUITE_P(
    Methods, DenseExact,
    testing::Combine(testing::Values(Method{"dense", estimate_plane_dense},
                                     Method{"score", estimate_plane_dense, DenseRefinement::kNelderMead},
                                     Method{"joint_dense", estimate_plane_joint_dense},
                                     Method{"fixed_plane", estimate_fixed_plane}),
                     testing::Bool()),
    [](const auto& tested) {
      return std::string(std::get<0>(tested.param).name) + (std::get<1>(tested.param) ? "_fisheye" : "_pinhole");
    });

class DenseStart : public testing::TestWithParam<std::tuple<double, double>> {};

TEST_P(DenseStart, OffByThreeDegreesAndFifteenPerCentConverges) {
  const auto [pitch_deg, factor] = GetParam();
  const TestRoadImages images = road(pinhole());
  RoadObservations observations = images.observations();
  observations.predicted_plane = changed(images.road, pitch_deg, factor);
  Rng rng(2);
  const auto measured = estimate_plane_dense(observations, {}, rng);
  ASSERT_TRUE(measured) << measured.error().message;
  EXPECT_NEAR(measured->plane.height / images.road.height, 1.0, kHeightBound);
  EXPECT_LT(tilt_deg(measured->plane, images.road), kTiltBoundDeg);
}
INSTANTIATE_TEST_SUITE_P(PitchAndHeight, DenseStart,
                         testing::Combine(testing::Values(-3.0, 0.0, 3.0), testing::Values(0.85, 1.0, 1.15)));

TEST(Dense, WithoutAPredictionTheHeightIsSearched) {
  const TestRoadImages images = road(pinhole());
  RoadObservations observations = images.observations();
  observations.predicted_plane.reset();
  Rng rng(3);
  const auto lost = estimate_plane_dense(observations, {}, rng);
  ASSERT_FALSE(lost);
  EXPECT_THAT(lost.error().message, HasSubstr("to start from"));
  observations.expected_normal = images.road.normal_in_cam;
  const auto measured = estimate_plane_dense(observations, {}, rng);
  ASSERT_TRUE(measured) << measured.error().message;
  EXPECT_NEAR(measured->plane.height / images.road.height, 1.0, kHeightBound);
}

TEST(Dense, BrightnessMayChange) {
  TestRoadImages images = road(pinhole());
  images.gain = 1.25;
  images.offset = -12.0;
  Rng rng(4);
  const auto measured = estimate_plane_dense(images.observations(), {}, rng);
  ASSERT_TRUE(measured) << measured.error().message;
  EXPECT_NEAR(measured->plane.height / images.road.height, 1.0, kHeightBound);
}

TEST(Dense, AFifthOfTheRegionThatIsSomethingElseHardlyMatters) {
  const TestRoadImages images = road(pinhole());
  RoadObservations observations = images.observations();
  // The left of the road in the second image is another road's.
  TestRoadImages other = images;
  other.seed = 7;
  const Image wrong = other.render(true);
  Image second = observations.images[1];
  for (int y = 0; y < second.height(); ++y) {
    for (int x = 0; x < 240; ++x) second.data()[y * second.width() + x] = wrong.at(x, y);
  }
  PlaneOptions options;
  options.dense.min_correlation = 0.2;
  Rng rng(5);
  const auto measured = estimate_plane_dense(observations, options, rng);
  ASSERT_TRUE(measured) << measured.error().message;
  // Wrong pixels keep a little weight in Cauchy's loss: ten times the bound of clean ones.
  EXPECT_NEAR(measured->plane.height / images.road.height, 1.0, 10.0 * kHeightBound);
}

TEST(Dense, WhatItSaysOfItsErrorsHolds) {
  int within = 0;
  constexpr int kTrials = 10;
  for (int trial = 0; trial < kTrials; ++trial) {
    TestRoadImages images = road(pinhole());
    images.seed = static_cast<std::uint64_t>(100 + trial);
    RoadObservations observations = images.observations();
    Rng noise(static_cast<std::uint64_t>(trial));
    for (Image& image : observations.images) {
      for (int i = 0; i < image.width() * image.height(); ++i) {
        const double grey = image.data()[i] + 3.0 * noise.normal();
        image.data()[i] = static_cast<std::uint8_t>(std::lround(std::clamp(grey, 0.0, 255.0)));
      }
    }
    const auto measured = estimate_plane_dense(observations, {}, noise);
    ASSERT_TRUE(measured) << measured.error().message;
    const Eigen::Vector3d m = images.road.inverse_form();
    const Eigen::Vector3d error = measured->plane.inverse_form() - m;
    const double sd = std::sqrt(m.dot(measured->covariance_of_m * m)) / m.norm();
    within += std::abs(error.dot(m.normalized())) < 3.0 * sd ? 1 : 0;
    EXPECT_LT(sd / m.norm(), 0.02);
  }
  EXPECT_GE(within, kTrials - 1);
}

TEST(Dense, RefusesWhatItCannotMeasure) {
  const RoadObservations good = road(pinhole()).observations();
  const auto reason = [](const RoadObservations& observations) {
    Rng rng(6);
    const auto measured = estimate_plane_dense(observations, {}, rng);
    return measured ? std::string("measured") : measured.error().message;
  };
  RoadObservations blind = good;
  blind.images.clear();
  EXPECT_THAT(reason(blind), HasSubstr("needs the pixels"));

  RoadObservations nowhere = good;
  nowhere.region = {};
  EXPECT_THAT(reason(nowhere), HasSubstr("region is empty"));
  nowhere.region = Image(good.camera->width(), good.camera->height());
  nowhere.region.data()[150 * good.camera->width() + 320] = 255;
  EXPECT_THAT(reason(nowhere), HasSubstr("pixels of the road are in both images"));

  RoadObservations small = good;
  small.images[1] = Image(320, 100);
  EXPECT_THAT(reason(small), HasSubstr("an image of 320x100 pixels"));

  RoadObservations standing = good;
  standing.cam_from_reference[1].translation.setZero();
  EXPECT_THAT(reason(standing), HasSubstr("baseline"));

  RoadObservations plain = good;
  for (Image& image : plain.images) {
    image = Image(image.width(), image.height());
    std::fill_n(image.data(), image.width() * image.height(), std::uint8_t{90});
  }
  EXPECT_NE(reason(plain), "measured");

  RoadObservations changed_world = good;
  TestRoadImages other = road(pinhole());
  other.seed = 9;
  changed_world.images[1] = other.render(true);
  EXPECT_NE(reason(changed_world), "measured");
}

TEST(FixedPlane, NeedsANormal) {
  const RoadObservations observations = road(pinhole()).observations();
  Rng rng(7);
  const auto measured = estimate_fixed_plane(observations, {}, rng);
  ASSERT_FALSE(measured);
  EXPECT_THAT(measured.error().message, HasSubstr("no normal"));
}

TEST(FixedPlane, AGivenPitchThatIsOffIsPaidForInHeight) {
  const TestRoadImages images = road(pinhole());
  RoadObservations observations = images.observations();
  observations.expected_normal = changed(images.road, 1.0, 1.0).normal_in_cam;
  Rng rng(8);
  const auto measured = estimate_fixed_plane(observations, {.fixed_plane = {.normal_sd_deg = 1.0}}, rng);
  ASSERT_TRUE(measured) << measured.error().message;
  const double error = std::abs(std::log(measured->plane.height / images.road.height));
  EXPECT_GT(error, 0.02);
  const Eigen::Vector3d m = measured->plane.inverse_form();
  EXPECT_LT(error, 2.0 * std::sqrt(m.dot(measured->covariance_of_m * m)) / m.squaredNorm());
}

class PhotometricDerivatives : public testing::TestWithParam<bool> {};

TEST_P(PhotometricDerivatives, AgreeWithFiniteDifferences) {
  const CameraPtr small =
      GetParam()
          ? KannalaBrandtCamera::create({.fx = 35.0, .fy = 35.0, .cx = 49.5, .cy = 15.5, .k1 = -0.02}, 100, 50).value()
          : PinholeCamera::create({.fx = 60.0, .fy = 60.0, .cx = 49.5, .cy = 12.5, .k1 = 0.02}, 100, 50).value();
  const TestRoadImages images = road(small);
  RoadObservations observations = images.observations();
  // Linear in the pixel: then it is so between pixels too, and the central difference is its slope.
  for (int y = 0; y < 50; ++y) {
    for (int x = 0; x < 100; ++x) observations.images[1].data()[y * 100 + x] = static_cast<std::uint8_t>(x + 2 * y);
  }
  PhotometricState state;
  state.motion = images.motion;
  state.m = changed(images.road, 0.3, 1.02).inverse_form();
  state.gain = 1.1;
  state.offset = 3.0;
  DenseOptions options;
  options.smooth_px = 0.0;
  const PhotometricLevel level(observations, state, options, 0);
  constexpr double kStep = 1e-4;  // grey levels come as floats
  int compared = 0;
  for (const RoadPixel& pixel : level.pixels()) {
    const auto pixel2 = small->project(state.homography() * pixel.ray);
    if (pixel2->x() < 2.0 || pixel2->y() < 2.0 || pixel2->x() > 97.0 || pixel2->y() > 47.0) continue;
    const auto error = level.error(pixel, state);
    ASSERT_TRUE(error);
    for (int k = 0; k < kPhotometricSize; ++k) {
      const PhotometricVector step = kStep * PhotometricVector::Unit(k);
      const auto plus = level.error(pixel, moved(state, step, FreeParameters::kMotion));
      const auto minus = level.error(pixel, moved(state, -step, FreeParameters::kMotion));
      const double numeric = -(plus->difference - minus->difference) / (2.0 * kStep);
      // 2e-5 of 200 grey levels, over two steps; and the curve of the camera model.
      EXPECT_NEAR(numeric, error->by_state[k], 0.15 + 1e-3 * std::abs(error->by_state[k]));
    }
    ++compared;
  }
  EXPECT_GT(compared, 50);
}
INSTANTIATE_TEST_SUITE_P(Cameras, PhotometricDerivatives, testing::Bool());

}  // namespace
}  // namespace groundscale
