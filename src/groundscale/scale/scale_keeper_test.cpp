#include "groundscale/scale/scale_keeper.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/scale/test_foreign_map_internal.hpp"

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kHeightM = ForeignMap::kHeightM;

/// 15 % of scale in 100 m: the map becomes smaller, so that a unit is more metres.
ForeignDrive drifting() {
  ForeignDrive drive;
  drive.log_unit = [](double along_m) { return std::log(1.15) * along_m / 100.0; };
  return drive;
}

/// The map shrinks at once, 40 m along the way.
ForeignDrive jumping(double ratio) {
  ForeignDrive drive;
  drive.log_unit = [ratio](double along_m) { return along_m < 40.0 ? 0.0 : std::log(ratio); };
  return drive;
}

ScaleKeeper keeper_of(ScaleCorrection correction, const ScaleKeeperOptions& options = {}) {
  ScaleKeeper keeper(kHeightM, correction, options);
  keeper.start(1.0, 0.1);
  return keeper;
}

/// Frames at which a correction was asked for; none is made.
std::vector<int> triggers(const ForeignDrive& drive, const ScaleKeeperOptions& options = {}) {
  const ForeignMap map(drive);
  ScaleKeeper keeper = keeper_of(ScaleCorrection::kTriggered, options);
  std::vector<int> result;
  for (int k = 0; k < map.frames(); ++k) {
    if (keeper.advance(map.input(k)).correction) result.push_back(k);
  }
  return result;
}

TEST(ScaleKeeper, MeasuresMetresPerUnit) {
  for (const double unit_m : {0.8, 1.0, 1.2}) {
    ForeignDrive drive;
    drive.log_unit = [unit_m](double) { return std::log(unit_m); };
    const ForeignMap map(drive);
    ScaleKeeper keeper(kHeightM, ScaleCorrection::kFiltered, {});
    keeper.start(1.0, 0.3);
    ScaleReport report;
    for (int k = 0; k < 60; ++k) report = keeper.advance(map.input(k));
    EXPECT_EQ(report.reason, "");
    // About 90 points of 5 mm on the path: 0.05 % of the height, twice that with the tilt; the held one is a mean.
    EXPECT_NEAR(report.measured.value() / unit_m, 1.0, 0.003);
    EXPECT_NEAR(report.held / unit_m, 1.0, 0.003);
    EXPECT_EQ(report.held, keeper.held());
    EXPECT_NEAR(report.plane_in_cam.height * unit_m, kHeightM, 0.003 * kHeightM);
    EXPECT_GT(report.points_on_path, 50);
    EXPECT_GT(static_cast<int>(report.inliers.size()), report.points_on_path * 9 / 10);
  }
}

TEST(ScaleKeeper, LambdaIsAboveOneWhereTheMapIsTooSmall) {
  for (const double ratio : {1.05, 0.95}) {
    const ForeignMap map(jumping(ratio));
    ScaleKeeper keeper = keeper_of(ScaleCorrection::kNone);
    ScaleReport report;
    for (int k = 0; k < 120; ++k) report = keeper.advance(map.input(k));
    ASSERT_TRUE(report.drift_ratio);
    EXPECT_DOUBLE_EQ(*report.drift_ratio, *report.measured / report.held);
    EXPECT_NEAR(*report.drift_ratio, ratio, 0.005);
    EXPECT_NEAR(report.held, 1.0, 0.005);
    EXPECT_FALSE(report.correction);
  }
}

TEST(ScaleKeeper, WithoutAMeasurementThereIsNoLambda) {
  const ForeignMap map({});
  ScaleKeeper keeper = keeper_of(ScaleCorrection::kFiltered);
  ScaleKeeper::Input input = map.input(30);
  input.road_points_in_world.clear();
  const ScaleReport report = keeper.advance(input);
  EXPECT_THAT(report.reason, testing::HasSubstr("road points"));
  EXPECT_FALSE(report.measured);
  EXPECT_FALSE(report.drift_ratio);
  EXPECT_DOUBLE_EQ(report.held, 1.0);
}

TEST(ScaleKeeper, FilteredFollowsADriftingMap) {
  const ForeignMap map(drifting());
  ScaleKeeper keeper = keeper_of(ScaleCorrection::kFiltered);
  for (int k = 0; k < map.frames(); ++k) {
    const ScaleReport report = keeper.advance(map.input(k));
    EXPECT_FALSE(report.correction);
    // Drift of 0.11 % a frame, and a filter that lags by some ten frames.
    if (k > 30) {
      EXPECT_NEAR(report.held / map.metres_per_unit(k), 1.0, 0.02) << k;
    }
  }
  const auto smoothed = keeper.smoothed();
  ASSERT_EQ(static_cast<int>(smoothed.size()), map.frames());
  for (int k = 10; k < map.frames() - 10; ++k) {
    const double scale = std::exp(smoothed[static_cast<std::size_t>(k)].log_scale);
    EXPECT_NEAR(scale / map.metres_per_unit(k), 1.0, 0.01) << k;
  }
}

TEST(ScaleKeeper, NoneAndTriggeredHoldTheScaleAfterTheFirstMetres) {
  for (const ScaleCorrection correction : {ScaleCorrection::kNone, ScaleCorrection::kTriggered}) {
    const ForeignMap map(drifting());
    ScaleKeeper keeper = keeper_of(correction);
    double settled = 0.0;
    for (int k = 0; k < map.frames(); ++k) {
      const double held = keeper.advance(map.input(k)).held;
      if (k * 0.8 < 15.0) settled = held;
      if (k * 0.8 > 16.0) {
        EXPECT_EQ(held, settled);
      }
    }
    EXPECT_NEAR(settled, map.metres_per_unit(18), 0.02);
  }
}

TEST(ScaleKeeper, CorrectsAMapThatHasDriftedAndHoldsTheSameScale) {
  for (const double sign : {1.0, -1.0}) {
    ForeignDrive drive = drifting();
    drive.log_unit = [sign](double along_m) { return sign * std::log(1.15) * along_m / 100.0; };
    ForeignMap map(drive);
    ScaleKeeper keeper = keeper_of(ScaleCorrection::kTriggered);
    int corrections = 0;
    for (int k = 0; k < map.frames(); ++k) {
      const ScaleReport report = keeper.advance(map.input(k));
      if (!report.correction) continue;
      ++corrections;
      EXPECT_GT(std::abs(*report.correction - 1.0), 0.075);
      // The median of five frames lies two frames back, and the points reach from behind to ahead.
      EXPECT_NEAR(*report.correction, map.metres_per_unit(k) / report.held, 0.01);
      map.scale(*report.correction);
      keeper.corrected(*report.correction);
      EXPECT_EQ(keeper.held(), report.held);
      const ScaleReport next = keeper.advance(map.input(++k));
      EXPECT_DOUBLE_EQ(next.held, report.held);
      EXPECT_NEAR(next.drift_ratio.value(), 1.0, 0.01);
    }
    EXPECT_GE(corrections, 2);
    EXPECT_EQ(static_cast<int>(keeper.smoothed().size()), map.frames());
  }
}

TEST(ScaleKeeper, ACorrectedMapHasSmallerUnits) {
  ForeignMap map({});
  ScaleKeeper keeper = keeper_of(ScaleCorrection::kFiltered);
  for (int k = 0; k < 80; ++k) keeper.advance(map.input(k));
  const double before = keeper.held();
  map.scale(1.25);
  keeper.corrected(1.25);
  EXPECT_NEAR(keeper.held(), before / 1.25, 1e-12);
  for (int k = 80; k < 160; ++k) {
    EXPECT_NEAR(keeper.advance(map.input(k)).drift_ratio.value(), 1.0, 0.005);
  }
  const auto smoothed = keeper.smoothed();
  for (std::size_t k = 0; k < smoothed.size(); ++k) {
    EXPECT_NEAR(std::exp(smoothed[k].log_scale), k < 80 ? 1.0 : 0.8, 0.003) << k;
  }
}

TEST(ScaleKeeper, SmallDriftIsNotCorrected) {
  EXPECT_TRUE(triggers(jumping(1.06)).empty());
  EXPECT_TRUE(triggers(jumping(0.94)).empty());
  EXPECT_FALSE(triggers(jumping(1.1)).empty());
  EXPECT_FALSE(triggers(jumping(0.9)).empty());
}

TEST(ScaleKeeper, NoCorrectionInATightTurn) {
  ForeignDrive drive = jumping(1.12);
  // 8 m/s on a radius of 20 m: 23 deg/s, from 5 m before the jump to the end.
  drive.curvature_per_m = [](double along_m) { return along_m < 35.0 ? 0.0 : 0.05; };
  EXPECT_TRUE(triggers(drive).empty());
  drive.curvature_per_m = [](double along_m) { return along_m < 35.0 || along_m > 80.0 ? 0.0 : 0.05; };
  const std::vector<int> after = triggers(drive);
  ASSERT_FALSE(after.empty());
  EXPECT_GE(after.front() * drive.step_m, 80.0);
}

TEST(ScaleKeeper, TheTurnRateThatIsGivenCounts) {
  const ForeignMap map(jumping(1.12));
  ScaleKeeper keeper = keeper_of(ScaleCorrection::kTriggered);
  for (int k = 0; k < map.frames(); ++k) {
    ScaleKeeper::Input input = map.input(k);
    input.turn_rate_dps = -15.0;
    EXPECT_FALSE(keeper.advance(input).correction);
  }
}

TEST(ScaleKeeper, NoCorrectionWhileSlow) {
  ForeignDrive drive = jumping(1.12);
  drive.dt_s = 2.0;  // 0.4 m/s
  EXPECT_TRUE(triggers(drive).empty());
  drive.dt_s = 1.0;  // 0.8 m/s
  EXPECT_FALSE(triggers(drive).empty());
}

TEST(ScaleKeeper, NoCorrectionByUncertainMeasurements) {
  ScaleKeeperOptions options;
  options.formal_factor = 100.0;
  EXPECT_TRUE(triggers(jumping(1.12), options).empty());
  options.max_trigger_sd = 0.2;
  EXPECT_FALSE(triggers(jumping(1.12), options).empty());
}

/// Whether frames in [from, to), whose heights are off by a factor each, bring about a correction.
bool triggered_by_bad_frames(int from, int to, double (*factor)(int)) {
  const ForeignMap map({});
  ScaleKeeper keeper = keeper_of(ScaleCorrection::kTriggered);
  bool triggered = false;
  for (int k = 0; k < map.frames(); ++k) {
    ScaleKeeper::Input input = map.input(k);
    if (k >= from && k < to) {
      for (Eigen::Vector3d& point : input.road_points_in_world) point.y() *= factor(k);
    }
    const ScaleReport report = keeper.advance(input);
    triggered |= report.correction.has_value();
    if (k == from) {
      EXPECT_NEAR(report.drift_ratio.value(), 1.0 / factor(k), 0.01);
    }
  }
  return triggered;
}

TEST(ScaleKeeper, NoCorrectionByABadFrameOrFour) {
  const auto deep = [](int) { return 1.15; };
  EXPECT_FALSE(triggered_by_bad_frames(80, 81, deep));
  EXPECT_FALSE(triggered_by_bad_frames(80, 84, deep));
  EXPECT_TRUE(triggered_by_bad_frames(80, 90, deep));
}

TEST(ScaleKeeper, AGoodMeasurementEndsTheRow) {
  EXPECT_FALSE(triggered_by_bad_frames(80, 100, [](int k) { return k % 4 == 3 ? 1.0 : 1.15; }));
}

TEST(ScaleKeeper, NoCorrectionByMeasurementsThatContradictEachOther) {
  EXPECT_FALSE(triggered_by_bad_frames(80, 100, [](int k) { return k % 4 < 2 ? 1.15 : 0.87; }));
}

TEST(ScaleKeeper, AHeightThatIsOffChangesWhatIsMeasuredByItsRatio) {
  ScaleKeeperOptions options;
  options.settle_m = 0.0;  // both hold the scale of the start
  const ForeignMap map(drifting());
  ScaleKeeper right(kHeightM, ScaleCorrection::kNone, options);
  ScaleKeeper wrong(1.1 * kHeightM, ScaleCorrection::kNone, options);
  right.start(1.0, 0.1);
  wrong.start(1.0, 0.1);
  for (int k = 0; k < map.frames(); ++k) {
    const ScaleReport a = right.advance(map.input(k));
    const ScaleReport b = wrong.advance(map.input(k));
    ASSERT_EQ(a.measured.has_value(), b.measured.has_value());
    if (a.measured) {
      EXPECT_NEAR(*b.measured / *a.measured, 1.1, 1e-12);
    }
    EXPECT_DOUBLE_EQ(a.held, b.held);
  }
}

TEST(ScaleKeeper, RefusesANormalThatIsOff) {
  const ForeignMap map({});
  ScaleKeeper keeper = keeper_of(ScaleCorrection::kFiltered);
  for (int k = 0; k < 40; ++k) {
    ScaleKeeper::Input input = map.input(k);
    input.mounting = {8.0 * kDegree, 0.0, 0.0};
    input.expected_normal = input.mounting.normal_in_cam();
    const ScaleReport report = keeper.advance(input);
    if (k < 20) continue;
    ASSERT_TRUE(report.measured);
    EXPECT_THAT(report.reason, testing::HasSubstr("normal"));
    EXPECT_DOUBLE_EQ(report.held, 1.0);
    EXPECT_GT(report.held_sd, 0.1);  // grows: nothing has counted
  }
}

TEST(ScaleKeeper, RefusesWhatIsSlowAndWhatIsUncertain) {
  ForeignDrive slow;
  slow.dt_s = 2.0;
  const ForeignMap map(slow);
  ScaleKeeper keeper = keeper_of(ScaleCorrection::kFiltered);
  keeper.advance(map.input(29));
  EXPECT_THAT(keeper.advance(map.input(30)).reason, testing::HasSubstr("speed"));

  ScaleKeeperOptions options;
  options.formal_factor = 100.0;
  options.max_sd = 0.02;
  const ForeignMap brisk({});
  ScaleKeeper doubtful = keeper_of(ScaleCorrection::kFiltered, options);
  doubtful.advance(brisk.input(29));
  EXPECT_THAT(doubtful.advance(brisk.input(30)).reason, testing::HasSubstr("sd of"));
}

TEST(ScaleKeeper, TheFrameRateMakesNoDifference) {
  struct End {
    double held, sd;
  };
  const auto end_of = [](double step_m, double dt_s) {
    ForeignDrive drive = drifting();
    drive.step_m = step_m;
    drive.dt_s = dt_s;
    drive.frames = static_cast<int>(std::lround(90.0 / step_m)) + 1;
    const ForeignMap map(drive);
    ScaleKeeper keeper = keeper_of(ScaleCorrection::kFiltered);
    for (int k = 0; k < map.frames(); ++k) keeper.advance(map.input(k));
    return End{keeper.held(), keeper.held_sd()};
  };
  const End slow = end_of(0.9, 0.1);
  const End fast = end_of(0.15, 1.0 / 60.0);
  // The points are others, drawn with the same noise.
  EXPECT_NEAR(fast.held / slow.held, 1.0, 0.003);
  EXPECT_NEAR(fast.sd / slow.sd, 1.0, 0.1);
}

TEST(ScaleKeeper, AtAHighFrameRateACorrectionTakesTheSameWay) {
  const auto way_of = [](double step_m, double dt_s) {
    ForeignDrive drive = jumping(1.12);
    drive.step_m = step_m;
    drive.dt_s = dt_s;
    drive.frames = static_cast<int>(std::lround(90.0 / step_m));
    const std::vector<int> frames = triggers(drive);
    return frames.empty() ? 0.0 : frames.front() * step_m;
  };
  // Within a step of the slower camera, and one to spare.
  EXPECT_NEAR(way_of(0.15, 1.0 / 60.0), way_of(0.9, 0.1), 1.8);
}

TEST(ScaleKeeper, AStandingCameraAddsNothing) {
  const ForeignMap map({});
  ScaleKeeper keeper = keeper_of(ScaleCorrection::kFiltered);
  for (int k = 0; k < 40; ++k) keeper.advance(map.input(k));
  const double held = keeper.held();
  const double sd = keeper.held_sd();
  for (int k = 0; k < 50; ++k) keeper.pass(0.1 * (40 + k), 0.0);
  EXPECT_DOUBLE_EQ(keeper.held(), held);
  EXPECT_NEAR(keeper.held_sd(), sd, 1e-6);
  EXPECT_EQ(keeper.smoothed().size(), 90U);
}

TEST(ScaleKeeper, GoesOnAfterAGap) {
  const ForeignMap map({});
  for (const ScaleCorrection correction : {ScaleCorrection::kFiltered, ScaleCorrection::kTriggered}) {
    ScaleKeeper keeper = keeper_of(correction);
    for (int k = 0; k < 40; ++k) keeper.advance(map.input(k));
    const double held = keeper.held();
    for (int k = 40; k < 50; ++k) keeper.skip();
    EXPECT_DOUBLE_EQ(keeper.held(), held);
    keeper.start(1.05, 0.1);  // a new map
    EXPECT_DOUBLE_EQ(keeper.held(), 1.05);
    for (int k = 50; k < 90; ++k) keeper.advance(map.input(k));
    EXPECT_NEAR(keeper.held(), 1.0, 0.005);
    EXPECT_EQ(keeper.smoothed().size(), 90U);
  }
}

TEST(ScaleKeeper, DistortedTurnsTeachTheDrift) {
  // 10 % of scale a radian, as a wrong calibration does it; two turns of a quarter to the two sides.
  ForeignDrive drive;
  drive.frames = 250;
  const auto turned_rad = [](double along_m) {
    return 0.05 * (std::clamp(along_m - 40.0, 0.0, 31.4) + std::clamp(along_m - 120.0, 0.0, 31.4));
  };
  drive.curvature_per_m = [](double along_m) {
    if (along_m >= 40.0 && along_m < 71.4) return 0.05;
    return along_m >= 120.0 && along_m < 151.4 ? -0.05 : 0.0;
  };
  drive.log_unit = [turned_rad](double along_m) { return 0.1 * turned_rad(along_m); };
  const ForeignMap map(drive);
  ScaleKeeper keeper = keeper_of(ScaleCorrection::kFiltered);
  double worst = 0.0;
  for (int k = 0; k < map.frames(); ++k) {
    ScaleKeeper::Input input = map.input(k);
    const bool second_turn = k * drive.step_m > 118.0;
    if (second_turn) input.road_points_in_world.clear();  // nothing to measure: the first turn must do
    const ScaleReport report = keeper.advance(input);
    if (second_turn) worst = std::max(worst, std::abs(std::log(report.held / map.metres_per_unit(k))));
  }
  // 16 % of drift in the second turn; a third of it is left at most.
  EXPECT_LT(worst, 0.05);
}

/// A drifting map without road points from 30 to 130 m, with a log that says `factor` times the true way. @return the
/// held scale over the true one at 130 m.
double held_over_true(ScaleCorrection correction, std::optional<double> factor) {
  const ForeignDrive drive = drifting();
  const ForeignMap map(drive);
  ScaleKeeper keeper = keeper_of(correction);
  int k = 0;
  for (; k * drive.step_m < 130.0; ++k) {
    ScaleKeeper::Input input = map.input(k);
    if (k * drive.step_m > 30.0) input.road_points_in_world.clear();
    if (factor) input.logged_step = LoggedStep{*factor * drive.step_m, 0.08};
    const ScaleReport report = keeper.advance(input);
    EXPECT_FALSE(report.by_log && report.reason.empty());
  }
  return keeper.held() / map.metres_per_unit(k - 1);
}

TEST(ScaleKeeper, ASpeedLogHoldsTheScaleWhereNoGroundIsSeen) {
  for (const ScaleCorrection correction : {ScaleCorrection::kFiltered, ScaleCorrection::kContinuous}) {
    EXPECT_LT(held_over_true(correction, std::nullopt), 0.9);  // 15 % of drift
    // The gain is the walk of a step over the log's sd, 0.002 sqrt(0.8) / 0.08 = 0.022: the filter lags by 45 steps,
    // and the map drifts by 0.11 % in each.
    EXPECT_NEAR(held_over_true(correction, 1.0), 0.95, 0.01);
  }
}

TEST(ScaleKeeper, WhereTheGroundCountsALogChangesNothing) {
  const ForeignMap map(drifting());
  ScaleKeeper with = keeper_of(ScaleCorrection::kFiltered);
  ScaleKeeper without = keeper_of(ScaleCorrection::kFiltered);
  for (int k = 0; k < map.frames(); ++k) {
    ScaleKeeper::Input input = map.input(k);
    const ScaleReport by_ground = without.advance(input);
    if (by_ground.reason.empty()) input.logged_step = LoggedStep{0.85, 0.01};
    const ScaleReport report = with.advance(input);
    EXPECT_FALSE(report.by_log);
    EXPECT_EQ(report.held, by_ground.held);
  }
}

TEST(ScaleKeeper, ALogThatIsGrosslyOffIsRefused) {
  EXPECT_DOUBLE_EQ(held_over_true(ScaleCorrection::kFiltered, 3.6), held_over_true(ScaleCorrection::kFiltered, {}));
}

TEST(ScaleKeeper, AHeldScaleIsNotMovedByALog) {
  for (const ScaleCorrection correction : {ScaleCorrection::kNone, ScaleCorrection::kTriggered}) {
    EXPECT_DOUBLE_EQ(held_over_true(correction, 1.0), held_over_true(correction, {}));
  }
}

TEST(ScalingAbout, KeepsTheCentreAndScalesDistances) {
  const Eigen::Vector3d centre(1.0, 2.0, -3.0);
  const Similarity scaling = scaling_about(centre, 1.25);
  EXPECT_LT((scaling * centre - centre).norm(), 1e-12);
  const Eigen::Vector3d offset(0.3, -0.2, 4.0);
  EXPECT_LT((scaling * Eigen::Vector3d(centre + offset) - centre - 1.25 * offset).norm(), 1e-12);
}

}  // namespace
}  // namespace groundscale
