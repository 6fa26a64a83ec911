#include "groundscale/road/fused.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/core/rng.hpp"

namespace groundscale {
namespace {

/// No floor: weights by the covariances alone.
const FusedOptions kNoFloor{.own_height_sd = 1e-5, .own_normal_deg = 1e-4};

FusedPart part(const Eigen::Vector3d& m, const Eigen::Vector3d& sd, double variance_factor = 1.0) {
  FusedPart one;
  one.measurement.plane = GroundPlane::from_inverse_form(m);
  one.measurement.covariance_of_m = sd.cwiseAbs2().asDiagonal();
  one.variance_factor = variance_factor;
  return one;
}

TEST(Fused, OneMeasurementStaysAsItIs) {
  const FusedPart one = part({0.01, 0.6, 0.02}, {0.001, 0.002, 0.003});
  const PlaneMeasurement fused = fuse_planes({one}, {});
  EXPECT_EQ(fused.plane.height, one.measurement.plane.height);
  EXPECT_EQ(fused.covariance_of_m, one.measurement.covariance_of_m);
}

TEST(Fused, EachDirectionFollowsWhoKnowsItBetter) {
  const Eigen::Vector3d m1(0.010, 0.600, 0.020);
  const Eigen::Vector3d m2(0.012, 0.602, 0.022);
  const PlaneMeasurement fused =
      fuse_planes({part(m1, {0.001, 0.002, 0.002}), part(m2, {0.002, 0.001, 0.002})}, kNoFloor);
  const Eigen::Vector3d m = fused.plane.inverse_form();
  // Variances of 1 : 4, 4 : 1 and 1 : 1. The floor's square is 1e-4 of the smallest of them.
  EXPECT_NEAR(m.x(), (4.0 * m1.x() + m2.x()) / 5.0, 1e-6);
  EXPECT_NEAR(m.y(), (m1.y() + 4.0 * m2.y()) / 5.0, 1e-6);
  EXPECT_NEAR(m.z(), 0.5 * (m1.z() + m2.z()), 1e-6);
}

TEST(Fused, WhatTwoMethodsShareDoesNotAverageOut) {
  const Eigen::Vector3d m(0.01, 0.6, 0.02);
  const Eigen::Vector3d sd(0.001, 0.002, 0.003);
  const PlaneMeasurement fused = fuse_planes({part(m, sd), part(m, sd)}, {});
  EXPECT_TRUE(fused.covariance_of_m.isApprox(part(m, sd).measurement.covariance_of_m, 1e-9));
}

TEST(Fused, CovarianceHoldsWhateverTheCorrelation) {
  // Errors of two methods drawn with any correlation: the fused error's covariance is never above what is said.
  const Eigen::Vector3d sd1(0.001, 0.003, 0.002);
  const Eigen::Vector3d sd2(0.002, 0.001, 0.004);
  const Eigen::Vector3d m(0.0, 0.6, 0.0);
  const auto fuse = [&](const Eigen::Vector3d& e1, const Eigen::Vector3d& e2) {
    return fuse_planes({part(m + e1, sd1), part(m + e2, sd2)},
                       {.own_height_sd = 1e-5, .own_normal_deg = 1e-4, .max_disagreement = 1000.0});
  };
  for (const double correlation : {-1.0, 0.0, 0.9, 1.0}) {
    Rng rng(1);
    Eigen::Vector3d squares = Eigen::Vector3d::Zero();
    constexpr int kTrials = 400;
    for (int trial = 0; trial < kTrials; ++trial) {
      const Eigen::Vector3d a(rng.normal(), rng.normal(), rng.normal());
      const Eigen::Vector3d b(rng.normal(), rng.normal(), rng.normal());
      const Eigen::Vector3d other = correlation * a + std::sqrt(1.0 - correlation * correlation) * b;
      const PlaneMeasurement fused = fuse(sd1.cwiseProduct(a), sd2.cwiseProduct(other));
      squares += (fused.plane.inverse_form() - m).cwiseAbs2();
    }
    const Eigen::Vector3d said = fuse({0, 0, 0}, {0, 0, 0}).covariance_of_m.diagonal();
    // The sample's variance is within 20 % of the true one (three sds of it).
    EXPECT_TRUE(((squares / kTrials).array() < 1.2 * said.array()).all()) << correlation;
  }
}

TEST(Fused, WhereTheyDisagreeTheMoreCertainOneStandsAlone) {
  const Eigen::Vector3d sure(0.01, 0.6, 0.02);
  const Eigen::Vector3d unsure(0.01, 0.8, 0.02);
  const Eigen::Vector3d sd(0.002, 0.002, 0.002);
  const PlaneMeasurement fused = fuse_planes({part(unsure, 3.0 * sd), part(sure, sd)}, {});
  EXPECT_TRUE(fused.plane.inverse_form().isApprox(sure, 1e-12));
  // What is known of its real errors decides, not what it says of itself.
  const PlaneMeasurement other = fuse_planes({part(unsure, 3.0 * sd), part(sure, sd, 100.0)}, kNoFloor);
  EXPECT_GT(other.plane.inverse_form().y(), 0.7);
}

TEST(Fused, NamesAreChecked) {
  EXPECT_TRUE(fused_methods({}));
  EXPECT_EQ(fused_methods({.methods = "sparse, fixed_plane"})->size(), 2U);
  for (const char* bad : {"", "sparse,dence", "fused", "sparse,fused"}) {
    const auto methods = fused_methods({.methods = bad});
    ASSERT_FALSE(methods) << bad;
    EXPECT_EQ(methods.error().code, ErrorCode::kBadInput);
  }
}

TEST(Fused, WhereAllRefuseTheReasonsAreTold) {
  RoadObservations observations;
  observations.camera = PinholeCamera::create({.fx = 100, .fy = 100, .cx = 50, .cy = 50}, 100, 100).value();
  observations.cam_from_reference = {RigidTransform{}, {Eigen::Matrix3d::Identity(), -Eigen::Vector3d::UnitZ()}};
  Rng rng(1);
  const auto measured = make_fused({})(observations, rng);
  ASSERT_FALSE(measured);
  EXPECT_THAT(measured.error().message, testing::HasSubstr("sparse: "));
  EXPECT_THAT(measured.error().message, testing::HasSubstr("dense: "));
}

}  // namespace
}  // namespace groundscale
