#include "groundscale/plane/normal_prior_internal.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
const Eigen::Vector3d kDown = Eigen::Vector3d::UnitY();
const Eigen::Vector3d kAhead = Eigen::Vector3d::UnitZ();

RoadObservations known(const Eigen::Vector3d& normal, const Eigen::Vector3d& direction) {
  RoadObservations observations;
  observations.expected_normal = normal;
  observations.driving_direction = direction;
  return observations;
}

/// A plane 1.6 m beneath, tilted from the level by pitch and roll.
Eigen::Vector3d tilted(double pitch_deg, double roll_deg) {
  return exp_so3({pitch_deg * kDegree, 0.0, roll_deg * kDegree}) * kDown / 1.6;
}

TEST(NormalPrior, CountsStandardDeviationsFromTheNormalAndFromTheDirection) {
  PlaneOptions options;
  options.normal_prior_deg = 1.0;
  options.direction_prior_deg = 0.5;
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  const NormalPrior normal(known(kDown, none), options);
  EXPECT_NEAR(normal.cost(tilted(2.0, 0.0)), 0.5 * 4.0, 1e-3);
  EXPECT_NEAR(normal.cost(tilted(0.0, 3.0)), 0.5 * 9.0, 1e-2);
  // The direction says nothing of roll.
  const NormalPrior direction(known(none, kAhead), options);
  EXPECT_NEAR(direction.cost(tilted(1.0, 0.0)), 0.5 * 4.0, 1e-3);
  EXPECT_NEAR(direction.cost(tilted(0.0, 3.0)), 0.0, 1e-12);
  const NormalPrior both(known(kDown, kAhead), options);
  EXPECT_NEAR(both.cost(tilted(1.0, 1.0)), normal.cost(tilted(1.0, 1.0)) + direction.cost(tilted(1.0, 1.0)), 1e-12);
}

TEST(NormalPrior, LessIsKnownOfTheNormalBeforeTheMountingHasSettled) {
  RoadObservations observations = known(kDown, kAhead);
  PlaneOptions options;
  options.direction_prior_deg = 0.0;
  const double settled = NormalPrior(observations, options).cost(tilted(1.0, 0.0));
  observations.normal_prior_factor = 3.0;
  EXPECT_NEAR(NormalPrior(observations, options).cost(tilted(1.0, 0.0)), settled / 9.0, 1e-12);
}

TEST(NormalPrior, IsNothingWhereNothingIsKnownOrWanted) {
  const Eigen::Vector3d m = tilted(2.0, 1.0);
  PlaneOptions off;
  off.normal_prior_deg = off.direction_prior_deg = 0.0;
  for (const NormalPrior& prior :
       {NormalPrior(), NormalPrior(RoadObservations{}, {}), NormalPrior(known(kDown, kAhead), off)}) {
    EXPECT_EQ(prior.cost(m), 0.0);
    EXPECT_TRUE(prior.gradient(m).isZero());
    EXPECT_TRUE(prior.hessian(m).isZero());
  }
}

TEST(NormalPrior, DerivativesAgreeWithFiniteDifferences) {
  const NormalPrior prior(known(kDown, Eigen::Vector3d(0.1, 0.02, 1.0).normalized()), {});
  const Eigen::Vector3d m = tilted(0.7, -0.4);
  constexpr double kStep = 1e-6;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
    EXPECT_NEAR((prior.cost(m + step) - prior.cost(m - step)) / (2.0 * kStep), prior.gradient(m)(k), 1e-4);
    const Eigen::Vector3d by_k = normal_by_m(m).col(k);
    const Eigen::Vector3d numeric = ((m + step).normalized() - (m - step).normalized()) / (2.0 * kStep);
    EXPECT_LT((by_k - numeric).norm(), 1e-8);
  }
  // Where the residuals are small it is the Hessian.
  const NormalPrior level(known(kDown, kAhead), {});
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
    const Eigen::Vector3d at = tilted(0.0, 0.0);
    const Eigen::Vector3d numeric = (level.gradient(at + step) - level.gradient(at - step)) / (2.0 * kStep);
    EXPECT_LT((level.hessian(at).col(k) - numeric).norm(), 1e-3 * level.hessian(at).norm());
  }
}

}  // namespace
}  // namespace groundscale
