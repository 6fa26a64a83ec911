#include "groundscale/plane/point_plane.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "groundscale/camera/mounting.hpp"
#include "groundscale/core/rng.hpp"

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kHeightM = 1.65;
const Mounting kMounting{2.0 * kDegree, -1.0 * kDegree, 0.0};

/// A road beneath the camera: its frame, and how it bends along the path.
struct Road {
  Mounting mounting = kMounting;
  double curvature_per_m = 0.0;

  /// The point `ahead_m` along the path and `aside_m` to its right, `above_m` the road.
  Eigen::Vector3d at(double ahead_m, double aside_m, double above_m = 0.0) const {
    const double down_m = kHeightM - 0.5 * curvature_per_m * ahead_m * ahead_m - above_m;
    return down_m * mounting.normal_in_cam() + ahead_m * mounting.forward_in_cam() + aside_m * mounting.right_in_cam();
  }
  /// Where the camera was: at its height above this road.
  Eigen::Vector3d centre(double behind_m) const { return at(-behind_m, 0.0, kHeightM); }
};

void add(PlanePoints& points, const Eigen::Vector3d& point, double weight = 1.0) {
  points.points_in_cam.push_back(point);
  points.weights.push_back(weight);
}

/// Points on a grid from 4 m behind to 10 m ahead, 2 m to each side.
PlanePoints grid_of(const Road& road) {
  PlanePoints points;
  points.forward_in_cam = road.mounting.forward_in_cam();
  for (int along = -8; along <= 20; ++along) {
    for (int aside = -4; aside <= 4; ++aside) add(points, road.at(0.5 * along, 0.5 * aside));
  }
  return points;
}

/// As a map has them: anywhere in that strip, with independent errors of height.
PlanePoints noisy_points(const Road& road, int count, double sd_m, Rng& rng) {
  PlanePoints points;
  points.forward_in_cam = road.mounting.forward_in_cam();
  for (int k = 0; k < count; ++k) {
    add(points, road.at(rng.uniform(-4.0, 10.0), rng.uniform(-2.0, 2.0), sd_m * rng.normal()));
  }
  return points;
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

PointPlaneOptions flat() {
  PointPlaneOptions options;
  options.curvature_sd_per_m = 0.0;
  return options;
}

TEST(FitPointPlane, FindsAnExactPlane) {
  const Road road;
  const auto found = fit_point_plane(grid_of(road), {});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->plane.height, kHeightM, 1e-9);
  EXPECT_LT(angle_between(found->plane.normal_in_cam, kMounting.normal_in_cam()), 1e-9);
  EXPECT_NEAR(found->curvature_per_m, 0.0, 1e-9);
  EXPECT_LT(found->rms_m, 1e-9);
  EXPECT_EQ(found->inliers.size(), grid_of(road).points_in_cam.size());
  EXPECT_TRUE(std::is_sorted(found->inliers.begin(), found->inliers.end()));
}

TEST(FitPointPlane, FindsThePlaneBeneathARoadThatBends) {
  for (const double curvature : {0.005, -0.005}) {
    const Road road{kMounting, curvature};
    PlanePoints points = grid_of(road);
    for (int k = 1; k <= 8; ++k) points.centres_in_cam.push_back(road.centre(k));
    PointPlaneOptions options;
    options.curvature_sd_per_m = 10.0;  // as good as free: nothing pulls it from the exact value
    const auto found = fit_point_plane(points, options);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->plane.height, kHeightM, 1e-6);
    EXPECT_NEAR(found->curvature_per_m, curvature, 1e-6);
    EXPECT_LT(angle_between(found->plane.normal_in_cam, kMounting.normal_in_cam()), 1e-6);

    const auto as_plane = fit_point_plane(points, flat());
    ASSERT_TRUE(as_plane);
    EXPECT_NEAR(as_plane->curvature_per_m, 0.0, 1e-9);
    // The same points without the curvature: 0.005 / m lifts a point 10 m ahead by 0.25 m.
    EXPECT_GT(std::abs(as_plane->plane.height - kHeightM), 0.02);
  }
}

TEST(FitPointPlane, LeavesOutKerbsAndCars) {
  const Road road;
  PlanePoints points = grid_of(road);
  const std::size_t on_road = points.points_in_cam.size();
  for (int along = -8; along <= 20; ++along) {  // 22 % of the points
    add(points, road.at(0.5 * along, 2.4, 0.12));
    if (along % 2 == 0) add(points, road.at(0.5 * along, -2.4, 0.9));
    if (along % 2 == 0) add(points, road.at(0.5 * along, 2.6, 0.12));
  }
  const auto found = fit_point_plane(points, {});
  ASSERT_TRUE(found);
  // Cauchy's loss: 12 cm are 12 sd of 1 cm, so that each kerb point pulls by a third of a centimetre at most.
  EXPECT_NEAR(found->plane.height, kHeightM, 0.005);
  EXPECT_LT(angle_between(found->plane.normal_in_cam, kMounting.normal_in_cam()), 0.3 * kDegree);
  EXPECT_EQ(found->inliers.size(), on_road);
  EXPECT_EQ(found->inliers.back(), static_cast<int>(on_road) - 1);
}

TEST(FitPointPlane, WithoutWeightPointsSayNothing) {
  const Road road;
  PlanePoints points = grid_of(road);
  for (int k = 0; k < 100; ++k) add(points, road.at(0.1 * k, 1.0, 0.3), 0.0);
  const auto found = fit_point_plane(points, {});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->plane.height, kHeightM, 1e-9);
}

/// Points on one line that runs ahead, half a metre to the right: their roll is open.
PlanePoints line_of(const Road& road) {
  PlanePoints points;
  points.forward_in_cam = road.mounting.forward_in_cam();
  for (int k = 8; k <= 30; ++k) add(points, road.at(0.5 * k, 0.5));
  return points;
}

TEST(FitPointPlane, PointsOnOneLineDetermineNoPlane) {
  const auto found = fit_point_plane(line_of({}), {});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kNotGround);
}

TEST(FitPointPlane, PointsOnOneSpotDetermineNoPlane) {
  PlanePoints points;
  for (int k = 0; k < 40; ++k) add(points, Road{}.at(6.0, 0.5));
  EXPECT_FALSE(fit_point_plane(points, {}));
}

TEST(FitPointPlane, TheCamerasOwnWayTiesWhatALineLeavesOpen) {
  const Road road;
  PlanePoints points;
  points.forward_in_cam = road.mounting.forward_in_cam();
  // Across the path, 8 m ahead: pitch is open, and height with it.
  for (int k = -12; k <= 12; ++k) add(points, road.at(8.0, 0.2 * k));
  EXPECT_FALSE(fit_point_plane(points, flat()));
  for (int k = 1; k <= 8; ++k) points.centres_in_cam.push_back(road.centre(k));
  const auto tied = fit_point_plane(points, flat());
  ASSERT_TRUE(tied);
  EXPECT_NEAR(tied->plane.height, kHeightM, 1e-6);
  EXPECT_LT(angle_between(tied->plane.normal_in_cam, kMounting.normal_in_cam()), 1e-6);
}

TEST(FitPointPlane, AWeakTieSaysLess) {
  const Road road;
  PlanePoints points = line_of(road);
  points.expected_normal = kMounting.normal_in_cam();
  for (int k = 1; k <= 8; ++k) points.centres_in_cam.push_back(road.centre(k));
  PointPlaneOptions weak;
  weak.tie_sd_m = 0.1;
  const auto strong_tie = fit_point_plane(points, {});
  const auto weak_tie = fit_point_plane(points, weak);
  ASSERT_TRUE(strong_tie);
  ASSERT_TRUE(weak_tie);
  EXPECT_LT(strong_tie->log_height_sd, 0.8 * weak_tie->log_height_sd);
}

TEST(FitPointPlane, WhatPointsLeaveOpenComesFromTheExpectedNormal) {
  const Road road;
  PlanePoints points = line_of(road);
  points.expected_normal = Mounting{kMounting.pitch_rad, 0.5 * kDegree, 0.0}.normal_in_cam();
  const auto found = fit_point_plane(points, {});
  ASSERT_TRUE(found);
  const PlaneAngles angles = plane_angles(found->plane.normal_in_cam);
  EXPECT_NEAR(angles.roll_rad, 0.5 * kDegree, 0.02 * kDegree);
  EXPECT_NEAR(angles.pitch_rad, kMounting.pitch_rad, 0.1 * kDegree);
  // The line lies half a metre aside, where 1.5 degrees of roll are 13 mm of height.
  EXPECT_NEAR(found->plane.height, kHeightM + 0.5 * std::sin(1.5 * kDegree), 0.003);
}

TEST(FitPointPlane, PriorsYieldToPoints) {
  PlanePoints points = grid_of({});
  points.expected_normal = Mounting{}.normal_in_cam();  // 2 degrees of pitch and 1 of roll off
  PointPlaneOptions stiff;
  stiff.pitch_prior_deg = stiff.roll_prior_deg = 0.01;
  const auto soft = fit_point_plane(points, {});
  const auto held = fit_point_plane(points, stiff);
  ASSERT_TRUE(soft);
  ASSERT_TRUE(held);
  EXPECT_LT(angle_between(soft->plane.normal_in_cam, kMounting.normal_in_cam()), 0.1 * kDegree);
  EXPECT_LT(angle_between(held->plane.normal_in_cam, points.expected_normal),
            0.5 * angle_between(kMounting.normal_in_cam(), points.expected_normal));
}

TEST(FitPointPlane, RefusesTooFewPointsAndPointsAboveTheCamera) {
  PlanePoints few = grid_of({});
  few.points_in_cam.resize(14);
  few.weights.resize(14);
  EXPECT_EQ(fit_point_plane(few, {}).error().code, ErrorCode::kTooFewMatches);
  EXPECT_EQ(fit_point_plane({}, {}).error().code, ErrorCode::kTooFewMatches);

  PlanePoints ceiling = grid_of({});
  for (Eigen::Vector3d& point : ceiling.points_in_cam) point.y() -= 4.0;
  EXPECT_EQ(fit_point_plane(ceiling, {}).error().code, ErrorCode::kNotGround);
}

TEST(FitPointPlane, IsTheSameInOtherMapUnits) {
  Rng rng(3);
  const Road road{kMounting, 0.003};
  PlanePoints in_metres = noisy_points(road, 200, 0.02, rng);
  for (int k = 1; k <= 8; ++k) in_metres.centres_in_cam.push_back(road.centre(k));
  in_metres.expected_normal = Mounting{}.normal_in_cam();
  const auto metric = fit_point_plane(in_metres, {});
  ASSERT_TRUE(metric);
  for (const double unit_m : {0.02, 0.7, 13.0}) {
    PlanePoints in_units = in_metres;
    in_units.metres_per_unit = unit_m;
    for (Eigen::Vector3d& point : in_units.points_in_cam) point /= unit_m;
    for (Eigen::Vector3d& centre : in_units.centres_in_cam) centre /= unit_m;
    const auto found = fit_point_plane(in_units, {});
    ASSERT_TRUE(found);
    EXPECT_NEAR(unit_m * found->plane.height, metric->plane.height, 1e-9);
    EXPECT_LT(angle_between(found->plane.normal_in_cam, metric->plane.normal_in_cam), 1e-9);
    EXPECT_NEAR(found->curvature_per_m, metric->curvature_per_m, 1e-9);
    EXPECT_NEAR(found->log_height_sd, metric->log_height_sd, 1e-9);
    EXPECT_NEAR(found->rms_m, metric->rms_m, 1e-9);
    EXPECT_EQ(found->inliers, metric->inliers);
  }
}

struct Scatter {
  double rms = 0.0;     ///< Of log(found / true height).
  double formal = 0.0;  ///< Root mean square of the formal sd.
};

Scatter scatter_of(double noise_m, const PointPlaneOptions& options) {
  constexpr int kRuns = 300;
  Rng rng(17);
  Scatter scatter;
  for (int run = 0; run < kRuns; ++run) {
    const auto found = fit_point_plane(noisy_points({}, 150, noise_m, rng), options);
    if (!found) return {};
    scatter.rms += std::pow(std::log(found->plane.height / kHeightM), 2) / kRuns;
    scatter.formal += std::pow(found->log_height_sd, 2) / kRuns;
  }
  return {std::sqrt(scatter.rms), std::sqrt(scatter.formal)};
}

TEST(FitPointPlane, ErrorsGrowWithTheNoiseAndNoFaster) {
  for (const double noise_m : {0.005, 0.01, 0.02, 0.05, 0.1}) {
    // 150 points in a strip of 14 by 4 m around the camera: sd of the mean, times 1.5 for the pitch that is found too
    // and the loss's efficiency.
    const double bound = 1.5 * noise_m / std::sqrt(150.0) / kHeightM;
    EXPECT_LT(scatter_of(noise_m, flat()).rms, bound) << noise_m;
  }
}

TEST(FitPointPlane, FormalSdIsTheScatterOfIndependentErrors) {
  for (const PointPlaneOptions& options : {flat(), PointPlaneOptions{}}) {
    for (const double noise_m : {0.02, 0.05}) {
      const Scatter scatter = scatter_of(noise_m, options);
      ASSERT_GT(scatter.rms, 0.0);
      // 300 runs give the scatter to 4 %; the loss's weights below 1 make the formal sd up to a quarter too large, and
      // with the curvature free to its prior the road here, which has none, is better known than that prior says.
      EXPECT_GT(scatter.formal / scatter.rms, 0.9) << noise_m;
      EXPECT_LT(scatter.formal / scatter.rms, 1.4) << noise_m;
    }
  }
}

TEST(FitPointPlane, NoPointSaysMoreThanTheRoadsRoughness) {
  const auto smooth = fit_point_plane(grid_of({}), {});
  PointPlaneOptions rough;
  rough.min_point_sd_m = 0.02;
  const auto twice = fit_point_plane(grid_of({}), rough);
  ASSERT_TRUE(smooth);
  ASSERT_TRUE(twice);
  EXPECT_GT(twice->log_height_sd, 1.5 * smooth->log_height_sd);
}

}  // namespace
}  // namespace groundscale
