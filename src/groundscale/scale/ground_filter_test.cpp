#include "groundscale/scale/ground_filter.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "groundscale/camera/mounting.hpp"
#include "groundscale/core/rng.hpp"

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kHeightM = 1.65;

TEST(ObservationOf, CarriesCovarianceThroughTheDerivativeByFiniteDifferences) {
  const Eigen::Vector3d m(0.03, 0.52, 0.04);
  Eigen::Matrix3d covariance;
  covariance << 4.0, 0.5, -0.3, 0.5, 2.0, 0.2, -0.3, 0.2, 3.0;
  covariance *= 1e-6;
  const auto values = [](const Eigen::Vector3d& at) {
    const auto o = observation_of(GroundPlane::from_inverse_form(at), Eigen::Matrix3d::Zero(), kHeightM);
    return Eigen::Vector3d(o.pitch_rad, o.roll_rad, o.log_distance);
  };
  constexpr double kStep = 1e-6;
  Eigen::Matrix3d by_m;
  for (int k = 0; k < 3; ++k) {
    by_m.col(k) =
        (values(m + kStep * Eigen::Vector3d::Unit(k)) - values(m - kStep * Eigen::Vector3d::Unit(k))) / (2.0 * kStep);
  }
  const auto observation = observation_of(GroundPlane::from_inverse_form(m), covariance, kHeightM);
  // Central differences of step 1e-6 are right to 1e-9.
  EXPECT_LT((observation.covariance - by_m * covariance * by_m.transpose()).norm(), 1e-8 * covariance.norm());
}

TEST(ObservationOf, ReadsAnglesAndMetresOfThePlane) {
  const GroundPlane plane{Mounting{0.03, -0.02, 0.0}.normal_in_cam(), 2.0};  // in baselines
  const auto observation = observation_of(plane, Eigen::Matrix3d::Zero(), kHeightM);
  EXPECT_NEAR(observation.pitch_rad, 0.03, 1e-12);
  EXPECT_NEAR(observation.roll_rad, -0.02, 1e-12);
  EXPECT_NEAR(std::exp(observation.log_distance), kHeightM / 2.0, 1e-12);
}

GroundObservation observed(double speed_mps, double pitch_rad = 0.0, double roll_rad = 0.0) {
  GroundObservation observation;
  observation.pitch_rad = pitch_rad;
  observation.roll_rad = roll_rad;
  observation.log_distance = std::log(0.1 * speed_mps);
  return observation;
}

GroundFilterOptions options_of(FilterKind kind) {
  GroundFilterOptions options;
  options.kind = kind;
  return options;
}

class AnyFilter : public testing::TestWithParam<FilterKind> {
 protected:
  std::unique_ptr<GroundFilter> filter_ = make_ground_filter(options_of(GetParam()), kHeightM);
};

TEST_P(AnyFilter, KnowsNothingBeforeItsStart) {
  EXPECT_FALSE(filter_->started());
  filter_->predict({});
  filter_->stand(0.1);
  filter_->reopen();
  EXPECT_FALSE(filter_->started());
  filter_->start(observed(8.0));
  EXPECT_TRUE(filter_->started());
}

TEST_P(AnyFilter, RecoversAConstantSpeedAndPlane) {
  // A start 20 % off, then exact measurements.
  filter_->start(observed(9.6, 0.02, -0.01));
  GroundStep along_road;
  along_road.direction = -Mounting{0.02, -0.01, 0.0}.forward_in_cam();
  for (int k = 0; k < 60; ++k) {
    filter_->predict(along_road);
    filter_->update(observed(8.0, 0.02, -0.01));
    EXPECT_TRUE(std::isfinite(filter_->state().pitch_rad));
  }
  const GroundState state = filter_->state();
  // The gain stays above a tenth with an acceleration of 2 m/s^2, so that 60 steps leave less than a thousandth.
  EXPECT_NEAR(state.speed_mps, 8.0, 0.008);
  EXPECT_NEAR(state.pitch_rad, 0.02, 1e-3);
  EXPECT_NEAR(state.roll_rad, -0.01, 1e-3);
}

TEST_P(AnyFilter, TrustsItselfLessWithoutMeasurements) {
  filter_->start(observed(8.0));
  for (int k = 0; k < 10; ++k) {
    filter_->predict({});
    filter_->update(observed(8.0));
  }
  double last = filter_->state().log_speed_sd;
  for (int k = 0; k < 10; ++k) {
    filter_->predict({});
    EXPECT_GT(filter_->state().log_speed_sd, last);
    last = filter_->state().log_speed_sd;
  }
}

TEST_P(AnyFilter, FollowsASpeedThatHasJumpedFasterAfterItWasReopened) {
  const auto speed_after_jump = [](bool reopen) {
    const auto filter = make_ground_filter(options_of(GetParam()), kHeightM);
    filter->start(observed(8.0));
    for (int k = 0; k < 20; ++k) {
      filter->predict(GroundStep{});
      filter->update(observed(8.0));
    }
    if (reopen) filter->reopen();
    filter->update(observed(12.0));
    return filter->state().speed_mps;
  };
  EXPECT_LT(speed_after_jump(false), 11.0);
  // Sd of 0.5 against a measurement's of 0.02: what is left is a percent of the jump.
  EXPECT_NEAR(speed_after_jump(true), 12.0, 0.2);
}

TEST_P(AnyFilter, ForgetsItsSpeedWhereTheVehicleStood) {
  filter_->start(observed(8.0));
  filter_->stand(0.1);
  const GroundState state = filter_->state();
  EXPECT_LT(state.speed_mps, 0.5);
  EXPECT_GE(state.log_speed_sd, 0.9);
}

TEST_P(AnyFilter, TakesTheLeadOffAPairsDistance) {
  filter_->start(observed(8.0));
  for (int k = 0; k < 60; ++k) {
    filter_->predict({});
    GroundObservation pair = observed(8.0);
    pair.lead_m = 1.6;  // two frames between
    pair.log_distance = std::log(1.6 + 0.8);
    filter_->update(pair);
  }
  EXPECT_NEAR(filter_->state().speed_mps, 8.0, 0.008);
}

TEST_P(AnyFilter, AShortStepAtTheEndOfALongPairDoesNotOvershoot) {
  filter_->start(observed(8.0));
  filter_->stand(0.1);
  // 3 cm by what was expected, at the end of 30 cm that turn out to be 34.
  GroundObservation pair = observed(0.3);
  pair.lead_m = 0.3;
  pair.log_distance = std::log(0.34);
  pair.covariance.diagonal() << 1e-6, 1e-6, 1e-6;
  filter_->update(pair);
  EXPECT_GT(filter_->state().speed_mps, 0.1);
  EXPECT_LT(filter_->state().speed_mps, 0.6);
  // One of 0.1 mm.
  filter_->update_speed(1e-3, 1e-3);
  filter_->reopen();
  filter_->update(pair);
  EXPECT_LT(filter_->state().speed_mps, 0.6);
}

TEST_P(AnyFilter, TakesASpeedFromElsewhere) {
  filter_->update_speed(8.0, 0.05);
  EXPECT_FALSE(filter_->started());
  filter_->start(observed(8.0, 0.02, -0.01));
  // Sd before and after, and the mean between both by their weights.
  const GroundState before = filter_->state();
  filter_->update_speed(8.2, before.log_speed_sd);
  const GroundState after = filter_->state();
  EXPECT_NEAR(after.log_speed_sd, before.log_speed_sd / std::sqrt(2.0), 0.02 * before.log_speed_sd);
  EXPECT_NEAR(after.speed_mps, 0.5 * (before.speed_mps + 8.2), 0.005);
  EXPECT_DOUBLE_EQ(after.pitch_rad, before.pitch_rad);
  for (int k = 0; k < 100; ++k) {
    filter_->predict({});
    filter_->update_speed(10.0, 0.05);
  }
  EXPECT_NEAR(filter_->state().speed_mps, 10.0, 0.01);
}

TEST_P(AnyFilter, SmoothedStatesAreNearerToTheTruthThanOnlineOnes) {
  Rng rng(11);
  std::vector<double> online, truth;
  double speed = 8.0;
  for (int k = 0; k < 300; ++k) {
    speed *= std::exp(0.01 * rng.normal());
    const GroundObservation noisy = observed(speed * std::exp(0.04 * rng.normal()));
    if (k == 0) {
      filter_->start(noisy);
    } else {
      filter_->predict({});
      filter_->update(noisy);
    }
    EXPECT_EQ(filter_->keep(), k);
    online.push_back(filter_->state().speed_mps);
    truth.push_back(speed);
  }
  const auto smoothed = filter_->smoothed();
  ASSERT_EQ(smoothed.size(), truth.size());
  double online_error = 0.0;
  double smoothed_error = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    online_error += std::pow(std::log(online[k] / truth[k]), 2);
    smoothed_error += std::pow(std::log(smoothed[k].speed_mps / truth[k]), 2);
  }
  EXPECT_LT(smoothed_error, 0.9 * online_error);
  EXPECT_DOUBLE_EQ(smoothed.back().speed_mps, online.back());
}

std::string kind_name(const testing::TestParamInfo<FilterKind>& info) {
  const std::vector<std::string> names = {"Paper", "Model", "PaperScale"};
  return names[static_cast<std::size_t>(info.param)];
}

INSTANTIATE_TEST_SUITE_P(Kinds, AnyFilter,
                         testing::Values(FilterKind::kModel, FilterKind::kPaper, FilterKind::kPaperScale), kind_name);

TEST(PaperScaleFilter, FiltersTheHeightAndTakesTheNormalAsItIsMeasured) {
  const auto filter = make_ground_filter(options_of(FilterKind::kPaperScale), kHeightM);
  filter->start(observed(10.0, 0.0));
  for (int k = 0; k < 20; ++k) {
    filter->predict(GroundStep{});
    filter->update(observed(10.0, 0.0));
  }
  filter->predict(GroundStep{});
  filter->update(observed(12.0, 0.02));
  EXPECT_NEAR(filter->state().pitch_rad, 0.02, 1e-9);
  EXPECT_GT(filter->state().speed_mps, 10.0);
  EXPECT_LT(filter->state().speed_mps, 12.0);
}

TEST(ModelFilter, IsConsistentOnItsOwnModel) {
  // Log speed is observed with the step model's noise alone and driven by acceleration: errors over their sd have a
  // mean square of one.
  const GroundFilterOptions options;
  constexpr int kDrives = 400;
  constexpr int kFrames = 30;
  double sum = 0.0;
  for (int drive = 0; drive < kDrives; ++drive) {
    Rng rng(100 + static_cast<std::uint64_t>(drive));
    const auto filter = make_ground_filter(options, kHeightM);
    double log_speed = std::log(10.0);
    for (int k = 0; k < kFrames; ++k) {
      if (k > 0) log_speed += options.acceleration_mps2 * 0.1 / std::exp(log_speed) * rng.normal();
      const GroundObservation noisy =
          observed(std::exp(log_speed + options.step_model * rng.normal()),
                   options.angle_model_deg * kDegree * rng.normal(), options.angle_model_deg * kDegree * rng.normal());
      if (k == 0) {
        filter->start(noisy);
      } else {
        filter->predict(GroundStep{});
        filter->update(noisy);
      }
    }
    const GroundState state = filter->state();
    sum += std::pow((std::log(state.speed_mps) - log_speed) / state.log_speed_sd, 2);
  }
  // Chi square of 400 numbers: 400 +- 28. Three sd and a half, and 1 % for the speed that the noise is taken at.
  EXPECT_NEAR(sum, kDrives, 3.5 * std::sqrt(2.0 * kDrives) + 4.0);
}

}  // namespace
}  // namespace groundscale
