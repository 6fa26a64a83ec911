#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/experiments/method_choice.hpp"
#include "groundscale/experiments/synthetic_results_internal.hpp"

namespace groundscale::internal {
namespace {

using testing::HasSubstr;

/// Features that a level camera sees 5 to 20 m ahead.
SyntheticBench bench_of_test(const std::vector<std::string>& methods) {
  SyntheticBench bench;
  bench.world.camera = *PinholeCamera::create({.fx = 700.0, .fy = 700.0, .cx = 600.0, .cy = 180.0}, 1200, 370);
  bench.options = synthetic_settings();
  std::vector<Eigen::Vector2d> features;
  for (int v = 240; v < 360; v += 12) {
    for (int u = 450; u < 750; u += 25) features.emplace_back(u, v);
  }
  bench.features = {features};
  bench.methods = *choose_ground_methods(methods, {});
  return bench;
}

SyntheticOptions few_trials() {
  SyntheticOptions options;
  options.trials = 40;
  options.noise_step_px = 0.5;
  return options;
}

void say_nothing(std::string_view) {}

/// Mean over the noise levels above 0.
double mean_of_medians(const SyntheticResults& results, std::size_t setting, std::size_t contender) {
  double sum = 0.0;
  for (std::size_t k = 1; k < results.noise_px.size(); ++k) sum += results.at(setting, k, contender).median();
  return sum / static_cast<double>(results.noise_px.size() - 1);
}

TEST(MeasureSynthetic, WithoutNoiseAndWithTheTrueMotionThePlaneIsExact) {
  SyntheticOptions options = few_trials();
  options.max_noise_px = 0.0;
  options.trials = 5;
  const SyntheticResults results = measure_synthetic(bench_of_test({"sparse"}), options, say_nothing);
  for (std::size_t setting = 0; setting < results.settings.size(); ++setting) {
    // With the motion measured, what its own iterations leave.
    EXPECT_LT(results.at(setting, 0, 0).median(), results.settings[setting].true_motion ? 1e-8 : 1e-4);
  }
}

TEST(MeasureSynthetic, ErrorGrowsWithTheNoiseAndFallsWithTheSpeed) {
  const SyntheticResults results = measure_synthetic(bench_of_test({"sparse"}), few_trials(), say_nothing);
  ASSERT_EQ(results.settings.size(), 4U);
  ASSERT_EQ(results.noise_px.size(), 5U);
  for (std::size_t setting = 0; setting < 4; ++setting) {
    for (std::size_t level = 1; level < results.noise_px.size(); ++level) {
      EXPECT_GT(results.at(setting, level, 0).median(), results.at(setting, level - 1, 0).median())
          << results.settings[setting].label() << ", " << results.noise_px[level] << " px";
    }
  }
  EXPECT_LT(mean_of_medians(results, 2, 0), mean_of_medians(results, 0, 0));  // true motion
  EXPECT_LT(mean_of_medians(results, 3, 0), mean_of_medians(results, 1, 0));  // estimated
}

TEST(MeasureSynthetic, DecompositionIsOnAverageNoBetterThanSparse) {
  const auto there = choose_ground_methods({"sparse", "decomposition"}, {});
  if (!there) GTEST_SKIP() << there.error().message;
  const SyntheticResults results =
      measure_synthetic(bench_of_test({"sparse", "decomposition"}), few_trials(), say_nothing);
  for (std::size_t setting = 0; setting < results.settings.size(); ++setting) {
    EXPECT_GE(mean_of_medians(results, setting, 1), mean_of_medians(results, setting, 0))
        << results.settings[setting].label();
  }
}

TEST(MeasureSynthetic, IsTheSameWhateverElseIsMeasured) {
  SyntheticOptions options = few_trials();
  options.trials = 2;
  const SyntheticResults alone = measure_synthetic(bench_of_test({"sparse"}), options, say_nothing);
  options.speeds_kmh = {50.0};
  options.max_noise_px = 0.5;
  const SyntheticResults again = measure_synthetic(bench_of_test({"sparse"}), options, say_nothing);
  EXPECT_EQ(alone.at(2, 1, 0).errors, again.at(0, 1, 0).errors);
}

/// Two settings of 10 and 50 km/h, three noise levels, with medians as they are told.
SyntheticResults made_up(const std::vector<SyntheticContender>& contenders,
                         const std::vector<std::vector<double>>& medians) {
  SyntheticResults results;
  results.settings = {{10.0, 0.3, true}, {50.0, 1.4, true}};
  results.noise_px = {0.0, 1.0, 2.0};
  results.contenders = contenders;
  std::size_t row = 0;
  for (const SyntheticSetting& setting : results.settings) {
    for (const double noise : results.noise_px) {
      for (std::size_t c = 0; c < contenders.size(); ++c) {
        const double error = medians[row][c];
        results.points.push_back({setting, noise, contenders[c], {0.9 * error, error, 1.1 * error}});
      }
      ++row;
    }
  }
  return results;
}

TEST(SyntheticFindings, HoldWhereTheyHoldAtEveryLevelThatTheyAreAbout) {
  const SyntheticResults results =
      made_up({{"triangulation", 0.0}, {"decomposition", 0.0}, {"sparse", 0.0}, {"joint", 0.0}},
              {{0, 0, 0, 0}, {3, 2, 1, 2}, {6, 4, 2, 1}, {9, 0, 0, 0}, {1, 3, 2, 4}, {2, 3, 4, 5}});
  const std::string findings = in_words(synthetic_findings(results));
  EXPECT_THAT(findings, HasSubstr("- reproduced: decomposition is worse than sparse (10 km/h, true R, t): at 2 of 2"));
  EXPECT_THAT(findings,
              HasSubstr("- not reproduced: decomposition is worse than sparse (50 km/h, true R, t): at 1 of 2"));
  EXPECT_THAT(findings, HasSubstr("- reproduced: triangulation is best at high speed (50 km/h, true R, t): at 2 of 2"));
  EXPECT_THAT(findings, HasSubstr("- reproduced: triangulation has twice the error of sparse beyond 1 px (10 km/h, "
                                  "true R, t): at 1 of 1 noise levels, 3.00 times"));
  EXPECT_THAT(findings, HasSubstr("- not reproduced: joint is worse than sparse (10 km/h, true R, t): at 1 of 2"));
  EXPECT_THAT(findings, HasSubstr("- reproduced: joint is worse than sparse (50 km/h, true R, t): at 2 of 2"));
}

TEST(SyntheticFindings, AreNotMeasuredWithoutTheirMethods) {
  const std::string findings = in_words(synthetic_findings(made_up({{"sparse", 0.0}}, {{0}, {1}, {2}, {0}, {1}, {2}})));
  EXPECT_THAT(findings, HasSubstr("- not measured: decomposition is worse than sparse"));
  EXPECT_THAT(findings, HasSubstr("- not measured: triangulation is best at high speed"));
  EXPECT_THAT(findings, HasSubstr("- not measured: joint is worse than sparse"));
  EXPECT_THAT(findings, testing::Not(HasSubstr("reproduced")));
}

TEST(SyntheticErrors, ARefusalIsTheLargestError) {
  SyntheticErrors point;
  constexpr double kRefused = std::numeric_limits<double>::infinity();
  point.errors = {0.1, kRefused, 0.2, 0.3, 0.4};
  EXPECT_EQ(point.median(), 0.3);
  EXPECT_EQ(point.refused(), 1);
  point.errors = {0.1, kRefused, kRefused};
  EXPECT_EQ(point.median(), kRefused);
}

}  // namespace
}  // namespace groundscale::internal
