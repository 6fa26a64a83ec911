// What every method in the table has to hold on a made-up road. Each one's own behaviour is in its own test.
#include "groundscale/plane/methods.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/plane/test_road_internal.hpp"

namespace groundscale {

std::ostream& operator<<(std::ostream& stream, const PlaneMethod& method) { return stream << method.name; }

namespace {

std::string name_of(const testing::TestParamInfo<PlaneMethod>& info) { return std::string(info.param.name); }

/// What the odometry hands over beside the points: where the normal is expected, and the plane.
RoadObservations with_expectation(RoadObservations observations) {
  observations.expected_normal = kTestRoad.normal_in_cam;
  observations.predicted_plane = kTestRoad;
  return observations;
}

class EveryMethod : public testing::TestWithParam<PlaneMethod> {
 protected:
  EstimatePlane make(const PlaneOptions& options = {}) const { return GetParam().make(options); }
};

TEST_P(EveryMethod, WithoutNoiseThePlaneIsThatOfTheRoadInEveryCamera) {
  for (const CameraPtr& camera : {test_camera(), test_camera(0.015), test_camera(-0.1), test_fisheye()}) {
    Rng rng(1);
    const auto measured = make()(with_expectation(test_road(camera, {}, rng)), rng);
    ASSERT_TRUE(measured) << measured.error().message;
    // Exact but for rounding, which small parallax and the turning back of distortion enlarge to some 1e-10.
    EXPECT_NEAR(measured->plane.height, kTestRoad.height, 1e-8);
    EXPECT_LT(tilt_deg(measured->plane), 1e-6);
    EXPECT_EQ(measured->inliers.size(), 250U);
    EXPECT_LT(measured->rms_px, 1e-6);
  }
}

TEST_P(EveryMethod, TheHeightHasTheUnitOfTheTranslation) {
  constexpr double kUnit = 0.37;
  Rng rng(2);
  RoadObservations observations = with_expectation(test_road(test_camera(), {.noise_px = 0.1}, rng));
  Rng rng_a(3);
  const auto one = make()(observations, rng_a);
  observations.cam_from_reference[1].translation *= kUnit;
  observations.predicted_plane->height *= kUnit;
  Rng rng_b(3);
  const auto other = make()(observations, rng_b);
  ASSERT_TRUE(one && other);
  // Iterations end where a step gains little, which rounding may move.
  EXPECT_NEAR(other->plane.height, kUnit * one->plane.height, 1e-6);
  EXPECT_LT((other->plane.normal_in_cam - one->plane.normal_in_cam).norm(), 1e-6);
  EXPECT_LT((kUnit * kUnit * other->covariance_of_m - one->covariance_of_m).norm(), 1e-3 * one->covariance_of_m.norm());
}

TEST_P(EveryMethod, TheSameSeedGivesTheSamePlane) {
  Rng rng(4);
  const RoadObservations observations =
      with_expectation(test_road(test_camera(), {.noise_px = 0.2, .wrong_share = 0.2}, rng));
  Rng rng_a(5);
  Rng rng_b(5);
  const auto one = make()(observations, rng_a);
  const auto other = make()(observations, rng_b);
  ASSERT_TRUE(one && other);
  EXPECT_EQ(one->plane.height, other->plane.height);
  EXPECT_EQ(one->plane.normal_in_cam, other->plane.normal_in_cam);
}

TEST_P(EveryMethod, NoisyPointsAndOutliersMoveTheHeightByFewPercentAndTheCovarianceSaysByHowMuch) {
  std::vector<double> errors;
  int within = 0;
  constexpr int kTrials = 20;
  for (int seed = 0; seed < kTrials; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    const auto measured =
        make()(with_expectation(test_road(test_camera(), {.noise_px = 0.2, .wrong_share = 0.2}, rng)), rng);
    ASSERT_TRUE(measured) << measured.error().message;
    const Eigen::Vector3d m = measured->plane.inverse_form();
    const double sd = std::sqrt(m.normalized().dot(measured->covariance_of_m * m.normalized())) / m.norm();
    errors.push_back(std::abs(measured->plane.height / kTestRoad.height - 1.0));
    if (errors.back() < 4.0 * sd) ++within;
    EXPECT_LT(sd, 0.05);
  }
  // 250 points of 0.2 px with parallaxes of 5 to 60 px; those of obstacles stand at 70 to 90 % of the height, and the
  // kernel of `triangulation`, a fiftieth of the distance, is wider than that: it is worst.
  EXPECT_LT(median(errors), 0.03);
  EXPECT_GE(within, kTrials * 3 / 4);  // independent errors would all be within: outliers near the road aren't noise
}

TEST_P(EveryMethod, RefusesTooFewPointsAndViewsWithoutABaseline) {
  Rng rng(6);
  const auto few = make()(with_expectation(test_road(test_camera(), {.count = 20}, rng)), rng);
  ASSERT_FALSE(few);
  EXPECT_EQ(few.error().code, ErrorCode::kTooFewMatches);
  EXPECT_THAT(few.error().message, testing::HasSubstr("30 needed"));

  RoadObservations standing = with_expectation(test_road(test_camera(), {}, rng));
  standing.cam_from_reference[1] = {};
  for (RoadPoint& point : standing.points) point.sights[0].pixel = point.pixel_in_reference;
  const auto still = make()(standing, rng);
  ASSERT_FALSE(still);
  EXPECT_EQ(still.error().code, ErrorCode::kDegenerateMotion) << still.error().message;
}

TEST_P(EveryMethod, AWallIsNotTakenForTheRoad) {
  Rng rng(7);
  RoadObservations wall = with_expectation(test_road(test_camera(), {}, rng));
  const GroundPlane plane{Eigen::Vector3d(0.1, 0.0, 1.0).normalized(), 12.0};
  for (RoadPoint& point : wall.points) {
    const Eigen::Vector3d ray = *test_camera()->ray(point.pixel_in_reference);
    point.sights[0].pixel = *test_camera()->project(kTestMotion * (ray * plane.height / plane.normal_in_cam.dot(ray)));
  }
  const auto measured = make()(wall, rng);
  // Refused, or with a normal that the gates refuse, or with few points that agree.
  if (!measured) return;
  EXPECT_TRUE(tilt_deg(measured->plane) > 5.0 || measured->inliers.size() < 100U)
      << tilt_deg(measured->plane) << " deg, " << measured->inliers.size();
}

INSTANTIATE_TEST_SUITE_P(Table, EveryMethod, testing::ValuesIn(plane_methods().begin(), plane_methods().end()),
                         name_of);

class MethodOfTheFreeNormal : public testing::TestWithParam<PlaneMethod> {};

TEST_P(MethodOfTheFreeNormal, PointsOnOneLineAreRefused) {
  Rng rng(8);
  RoadObservations line = with_expectation(test_road(test_camera(), {}, rng));
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const Eigen::Vector3d ray(0.001 * static_cast<double>(i) - 0.1, 0.15, 1.0);
    line.points[i].pixel_in_reference = *test_camera()->project(ray);
    line.points[i].sights[0].pixel =
        *test_camera()->project(kTestMotion * (ray * kTestRoad.height / kTestRoad.normal_in_cam.dot(ray)));
  }
  const auto measured = GetParam().make({})(line, rng);
  EXPECT_FALSE(measured) << measured->plane.height;
}

std::vector<PlaneMethod> methods_of_the_free_normal() {
  std::vector<PlaneMethod> chosen;
  for (const PlaneMethod& method : plane_methods()) {
    if (!method.scale_alone || method.name == "decomposition") chosen.push_back(method);
  }
  return chosen;
}
INSTANTIATE_TEST_SUITE_P(Table, MethodOfTheFreeNormal, testing::ValuesIn(methods_of_the_free_normal()), name_of);

TEST(PlaneOptions, DefaultsLieWithinTheirRanges) { EXPECT_TRUE(check_ranges(PlaneOptions{})); }

}  // namespace
}  // namespace groundscale
