#include "groundscale/scale/map_scale_filter.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "groundscale/core/rng.hpp"

namespace groundscale {
namespace {

constexpr double kQuarterTurn = 0.5 * std::numbers::pi;
constexpr double kStepM = 0.8;

/// Frames of a drive: straight, turn, straight, turn, straight, with what the filter's own model makes of them.
struct Drive {
  std::vector<double> turns_rad;
  std::vector<double> truth;     ///< log scale
  std::vector<double> measured;  ///< with noise
  double drift_per_rad = 0.0;    ///< at the end
};

std::vector<double> turns_of_a_drive() {
  std::vector<double> turns;
  for (int part = 0; part < 5; ++part) {
    const bool turning = part % 2 == 1;
    for (int k = 0; k < 40; ++k) turns.push_back(turning ? (part == 1 ? 1.0 : -1.0) * kQuarterTurn / 40.0 : 0.0);
  }
  return turns;
}

constexpr double kMeasuredSd = 0.02;

Drive drawn_from(const MapScaleFilterOptions& options, double start, Rng& rng) {
  Drive drive;
  drive.turns_rad = turns_of_a_drive();
  double scale = start + options.start_sd * rng.normal();
  double drift = options.turn_drift_sd * rng.normal();
  for (const double turn : drive.turns_rad) {
    const double angle = std::abs(turn);
    scale +=
        drift * angle +
        std::sqrt(options.walk * options.walk * kStepM + options.turn_walk * options.turn_walk * angle) * rng.normal();
    drift += options.turn_drift_walk * std::sqrt(kStepM) * rng.normal();
    drive.truth.push_back(scale);
    drive.measured.push_back(scale + kMeasuredSd * rng.normal());
  }
  drive.drift_per_rad = drift;
  return drive;
}

std::vector<double> filtered(const Drive& drive, MapScaleFilter& filter) {
  std::vector<double> online;
  for (std::size_t k = 0; k < drive.turns_rad.size(); ++k) {
    filter.predict(kStepM, drive.turns_rad[k]);
    filter.update(drive.measured[k], kMeasuredSd);
    filter.keep();
    online.push_back(filter.log_scale());
  }
  return online;
}

TEST(MapScaleFilter, ConvergesToAConstantScale) {
  MapScaleFilter filter({});
  filter.start(0.3, 0.1);
  for (int k = 0; k < 200; ++k) {
    filter.predict(kStepM, 0.0);
    filter.update(0.5, kMeasuredSd);
  }
  EXPECT_NEAR(filter.log_scale(), 0.5, 1e-6);
  // The steady state of a random walk with variance q a step and measurements of variance r: q r = p^2 + p q (p before
  // the update, p r / (p + r) after it).
  const double walk = MapScaleFilterOptions{}.walk;
  const double q = walk * walk * kStepM;
  const double r = kMeasuredSd * kMeasuredSd;
  const double predicted = 0.5 * (q + std::sqrt(q * q + 4.0 * q * r));
  EXPECT_NEAR(filter.sd(), std::sqrt(predicted * r / (predicted + r)), 1e-5);
}

TEST(MapScaleFilter, WithoutMeasurementsGrowsUncertainByItsModel) {
  const MapScaleFilterOptions options;
  MapScaleFilter filter(options);
  filter.start(0.0, 0.01);
  for (int k = 0; k < 100; ++k) filter.predict(0.25, 0.0);
  const double straight = 0.01 * 0.01 + options.walk * options.walk * 25.0;
  EXPECT_NEAR(filter.sd(), std::sqrt(straight), 1e-7);  // 1e-12 a step is for the smoother
  filter.predict(0.0, kQuarterTurn);
  const double drift_sd = std::hypot(options.turn_drift_sd, options.turn_drift_walk * 5.0);
  const double turn = options.turn_walk * options.turn_walk * kQuarterTurn + std::pow(kQuarterTurn * drift_sd, 2);
  EXPECT_NEAR(filter.sd(), std::sqrt(straight + turn), 1e-7);
}

TEST(MapScaleFilter, LearnsTheDriftInATurnAndPredictsItInTheNext) {
  constexpr double kDrift = -0.1;
  MapScaleFilterOptions options;
  options.turn_drift_sd = 0.15;
  options.turn_walk = 0.01;
  MapScaleFilter filter(options);
  filter.start(0.0, 0.02);
  double truth = 0.0;
  const auto drive = [&](int frames, double turn_rad, bool measured) {
    for (int k = 0; k < frames; ++k) {
      truth += kDrift * std::abs(turn_rad);
      filter.predict(kStepM, turn_rad);
      if (measured) filter.update(truth, 0.01);
    }
  };
  drive(30, 0.0, true);
  EXPECT_NEAR(filter.drift_per_rad(), 0.0, 1e-9);  // a straight says nothing about it
  drive(30, kQuarterTurn / 30.0, true);
  EXPECT_NEAR(filter.drift_per_rad(), kDrift, 0.02);
  EXPECT_LT(filter.drift_per_rad_sd(), 0.03);
  drive(30, 0.0, true);
  // A turn to the other side, without ground: 16 % of scale go, and are known to within 2 sd.
  drive(30, -kQuarterTurn / 30.0, false);
  EXPECT_NEAR(filter.log_scale(), truth, 0.03);
  EXPECT_LT(std::abs(filter.log_scale() - truth), 2.0 * filter.sd());
}

TEST(MapScaleFilter, OneOutlierMovesItLittle) {
  for (const double off : {0.2, 0.5, 3.0}) {
    MapScaleFilter filter({});
    filter.start(0.0, 0.05);
    for (int k = 0; k < 50; ++k) {
      filter.predict(kStepM, 0.0);
      filter.update(0.0, kMeasuredSd);
    }
    const double before_sd = filter.sd();
    filter.predict(kStepM, 0.0);
    filter.update(off, kMeasuredSd);
    // However far off: Huber's bound of 2.5 sd times the gain, which is below 0.1 here.
    EXPECT_LT(filter.log_scale(), 2.5 * kMeasuredSd * 0.12);
    EXPECT_GT(filter.sd(), 0.9 * before_sd);
  }
}

struct Ensemble {
  double online_squares = 0.0, final_squares = 0.0;
  double nees_scale = 0.0, nees_final = 0.0, nees_drift = 0.0;
};

constexpr int kRuns = 400;

Ensemble ensemble_of(const MapScaleFilterOptions& options) {
  Ensemble mean;
  Rng rng(5);
  for (int run = 0; run < kRuns; ++run) {
    const Drive drive = drawn_from(options, 0.2, rng);
    MapScaleFilter filter(options);
    filter.start(0.2, options.start_sd);
    const std::vector<double> online = filtered(drive, filter);
    const std::vector<MapScaleFilter::Smoothed> smoothed = filter.smoothed();
    for (std::size_t k = 0; k < online.size(); ++k) {
      mean.online_squares += std::pow(online[k] - drive.truth[k], 2) / kRuns;
      mean.final_squares += std::pow(smoothed[k].log_scale - drive.truth[k], 2) / kRuns;
    }
    constexpr std::size_t kInTheFirstTurn = 60;
    mean.nees_final +=
        std::pow((smoothed[kInTheFirstTurn].log_scale - drive.truth[kInTheFirstTurn]) / smoothed[kInTheFirstTurn].sd,
                 2) /
        kRuns;
    mean.nees_scale += std::pow((filter.log_scale() - drive.truth.back()) / filter.sd(), 2) / kRuns;
    mean.nees_drift += std::pow((filter.drift_per_rad() - drive.drift_per_rad) / filter.drift_per_rad_sd(), 2) / kRuns;
  }
  return mean;
}

TEST(MapScaleFilter, IsConsistentOnItsOwnModel) {
  MapScaleFilterOptions lively;
  lively.walk = 0.01;
  lively.turn_walk = 0.05;
  for (const MapScaleFilterOptions& options : {MapScaleFilterOptions{}, lively}) {
    const Ensemble mean = ensemble_of(options);
    // 400 independent runs of one number: chi-square / 400 within 1 -+ 3.3 sd (99.9 %), sd = sqrt(2 / 400).
    const double bound = 3.3 * std::sqrt(2.0 / kRuns);
    EXPECT_NEAR(mean.nees_scale, 1.0, bound);
    EXPECT_NEAR(mean.nees_final, 1.0, bound);
    EXPECT_NEAR(mean.nees_drift, 1.0, bound);
  }
}

TEST(MapScaleFilter, SmoothingMakesItBetter) {
  const Ensemble mean = ensemble_of({});
  EXPECT_LT(mean.final_squares, 0.7 * mean.online_squares);
}

TEST(MapScaleFilter, SmoothedSdIsNeverAboveTheOnlineOne) {
  Rng rng(9);
  for (int run = 0; run < 50; ++run) {
    const Drive drive = drawn_from({}, 0.0, rng);
    MapScaleFilter filter({});
    filter.start(0.0, 0.1);
    std::vector<double> sds;
    for (std::size_t k = 0; k < drive.turns_rad.size(); ++k) {
      filter.predict(kStepM, drive.turns_rad[k]);
      if (rng.uniform() < 0.7) filter.update(drive.measured[k], kMeasuredSd);
      filter.keep();
      sds.push_back(filter.sd());
    }
    const auto smoothed = filter.smoothed();
    for (std::size_t k = 0; k < sds.size(); ++k) EXPECT_LE(smoothed[k].sd, sds[k] * (1.0 + 1e-9)) << k;
  }
}

TEST(MapScaleFilter, KeepsFramesInOrderAndEndsWithTheOnlineState) {
  MapScaleFilter filter({});
  EXPECT_TRUE(filter.smoothed().empty());
  filter.start(0.0, 0.5);
  for (int k = 0; k < 30; ++k) {
    filter.predict(50.0, 0.0);
    filter.update(0.01 * k, 1e-4);
    filter.keep();
  }
  const auto smoothed = filter.smoothed();
  ASSERT_EQ(smoothed.size(), 30U);
  for (std::size_t k = 0; k < 30; ++k) EXPECT_NEAR(smoothed[k].log_scale, 0.01 * static_cast<double>(k), 1e-3);
  EXPECT_EQ(smoothed.back().log_scale, filter.log_scale());
  EXPECT_EQ(smoothed.back().sd, filter.sd());
}

TEST(MapScaleFilter, ANewStartCutsTheHistoryButKeepsTheDrift) {
  MapScaleFilter filter({});
  filter.start(0.0, 0.01);
  double truth = 0.0;
  for (int k = 0; k < 40; ++k) {
    truth -= 0.1 * 0.04;
    filter.predict(kStepM, 0.04);
    filter.update(truth, 0.01);
    filter.keep();
  }
  const double drift = filter.drift_per_rad();
  const double last = filter.log_scale();
  filter.start(2.0, 0.1);
  EXPECT_EQ(filter.log_scale(), 2.0);
  EXPECT_NEAR(filter.sd(), 0.1, 1e-12);
  EXPECT_EQ(filter.drift_per_rad(), drift);
  for (int k = 0; k < 40; ++k) {
    filter.predict(kStepM, 0.0);
    filter.update(2.1, 0.01);
    filter.keep();
  }
  filter.start(-1.0, 0.1);
  filter.keep();
  const auto smoothed = filter.smoothed();
  ASSERT_EQ(smoothed.size(), 81U);
  EXPECT_EQ(smoothed[39].log_scale, last);  // the last of its map: nothing comes back from the next
  EXPECT_NEAR(smoothed[40].log_scale, 2.1, 0.01);
  EXPECT_EQ(smoothed[80].log_scale, -1.0);
}

TEST(MapScaleFilter, AChangeOfUnitIsOnlyThat) {
  Rng rng(13);
  const Drive drive = drawn_from({}, 0.0, rng);
  const double log_ratio = std::log(0.9);
  MapScaleFilter same({});
  MapScaleFilter changed({});
  constexpr std::size_t kChange = 90;
  for (std::size_t k = 0; k < drive.turns_rad.size(); ++k) {
    if (k == kChange) changed.change_unit(log_ratio);
    for (MapScaleFilter* filter : {&same, &changed}) {
      filter->predict(kStepM, drive.turns_rad[k]);
      filter->update(drive.measured[k] + (filter == &changed && k >= kChange ? log_ratio : 0.0), kMeasuredSd);
      filter->keep();
    }
  }
  const auto expected = same.smoothed();
  const auto found = changed.smoothed();
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_NEAR(found[k].log_scale, expected[k].log_scale + (k >= kChange ? log_ratio : 0.0), 1e-9);
    EXPECT_NEAR(found[k].sd, expected[k].sd, 1e-12);
  }
}

TEST(MapScaleFilter, WithoutAnyNoiseStaysFinite) {
  MapScaleFilterOptions still;
  still.walk = still.turn_walk = 0.0;
  still.turn_drift_walk = still.turn_drift_sd = 0.0;
  for (const double start_sd : {0.0, 0.1}) {
    MapScaleFilter filter(still);
    filter.start(0.5, start_sd);
    for (int k = 0; k < 200; ++k) {
      filter.predict(k % 3 == 0 ? 0.0 : kStepM, k % 5 == 0 ? 0.02 : 0.0);
      if (k % 2 == 0) filter.update(0.5, 0.01);
      filter.keep();
    }
    for (const auto& frame : filter.smoothed()) {
      EXPECT_NEAR(frame.log_scale, 0.5, 1e-9);
      EXPECT_TRUE(std::isfinite(frame.sd));
    }
  }
}

TEST(MapScaleFilter, AStartReachesBackToTheFramesThatBelongToIt) {
  MapScaleFilter filter({});
  filter.start(1.0, 0.1);
  for (int k = 0; k < 4; ++k) filter.keep();
  filter.start(0.0, 0.1);
  filter.keep_again(3);
  filter.predict(1.0, 0.0);
  filter.update(0.2, 1e-3);
  filter.keep();
  const auto smoothed = filter.smoothed();
  ASSERT_EQ(smoothed.size(), 5U);
  EXPECT_NEAR(smoothed[0].log_scale, 1.0, 1e-12);
  for (std::size_t k = 1; k < 5; ++k) EXPECT_NEAR(smoothed[k].log_scale, 0.2, 0.01) << k;
}

}  // namespace
}  // namespace groundscale
