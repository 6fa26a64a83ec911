#include "groundscale/scale/speed_reference.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace groundscale {
namespace {

/// A speed a row, rows `interval_s` apart from 100 s on.
SpeedReference reference_of(const std::vector<double>& speeds_mps, double interval_s = 1.0,
                            const SpeedReferenceOptions& options = {}) {
  std::vector<SpeedSample> samples;
  for (const double speed_mps : speeds_mps) {
    samples.push_back({100.0 + interval_s * static_cast<double>(samples.size()), speed_mps});
  }
  return {SpeedLog::create(std::move(samples)).value(), options};
}

SpeedReference steady(double speed_mps, double interval_s = 1.0, const SpeedReferenceOptions& options = {}) {
  return reference_of(std::vector<double>(20, speed_mps), interval_s, options);
}

TEST(SpeedReference, GivesTheWayBetweenTwoTimesByTheVideosClock) {
  SpeedReferenceOptions options;
  options.offset_s = 98.0;  // the log's 100 s are the video's 2 s
  const SpeedReference speed = reference_of({4, 6, 8, 8, 8, 8}, 1.0, options);
  EXPECT_NEAR(speed.step(2.0, 3.0).value().distance_m, 5.0, 1e-9);
  EXPECT_NEAR(speed.step(3.4, 3.5).value().distance_m, 0.1 * 6.9, 1e-9);
  EXPECT_FALSE(speed.step(1.9, 2.1));
  EXPECT_FALSE(speed.step(6.9, 7.1));
  EXPECT_FALSE(speed.step(3.0, 3.0));
}

TEST(SpeedReference, SaysNothingInAGapAndAtACrawl) {
  std::vector<SpeedSample> samples;
  for (int k = 0; k < 20; ++k) samples.push_back({static_cast<double>(k), k < 10 ? 1.4 : 1.6});
  samples[15].after_gap = true;
  const SpeedReference speed(SpeedLog::create(samples).value(), {});
  EXPECT_FALSE(speed.step(5.0, 5.1));
  EXPECT_TRUE(speed.step(12.0, 12.1));
  EXPECT_FALSE(speed.step(13.95, 14.05));
  EXPECT_FALSE(speed.step(14.5, 14.6));
  EXPECT_TRUE(speed.step(15.0, 15.1));
}

TEST(SpeedReference, ASecondOfStepsCountsAsOneSpeedWhateverTheRates) {
  const double one = std::hypot(0.2 / 8.0, 0.01);
  const auto sd_of_a_second = [](const SpeedReference& speed, int frames) {
    const double step_sd = speed.step(100.5, 100.5 + 1.0 / frames).value().log_sd;
    return step_sd / std::sqrt(frames);
  };
  for (const int frames : {1, 10, 30}) {
    EXPECT_NEAR(sd_of_a_second(steady(8.0), frames), one, 1e-6) << frames;
    EXPECT_NEAR(sd_of_a_second(steady(8.0, 0.1), frames), one, 1e-6) << frames;  // a fast log knows no more
    EXPECT_NEAR(sd_of_a_second(steady(8.0, 4.0), frames), 2.0 * one, 1e-6) << frames;
  }
  EXPECT_NEAR(steady(8.0).step(101.0, 104.0).value().log_sd, one, 1e-9);
}

TEST(SpeedReference, AgreesUntilTheMedianIsGrosslyOff) {
  SpeedReference speed = steady(8.0);
  EXPECT_FALSE(speed.ratio());
  for (int k = 0; k < 4; ++k) speed.compare({3.6, 0.1}, 1.0);
  EXPECT_TRUE(speed.agrees());  // too few to say
  EXPECT_FALSE(speed.ratio());
  speed.compare({3.6, 0.1}, 1.0);
  EXPECT_FALSE(speed.agrees());
  EXPECT_NEAR(speed.ratio().value(), 3.6, 1e-9);
  EXPECT_EQ(speed.compared(), 5);
  // The latest 50 count.
  for (int k = 0; k < 60; ++k) speed.compare({1.05, 0.1}, 1.0);
  EXPECT_TRUE(speed.agrees());
  EXPECT_NEAR(speed.ratio().value(), 1.05, 1e-9);
}

TEST(SpeedReference, MoreIsLetInWhereLessIsKnown) {
  const LoggedStep logged{0.8, 0.05};
  EXPECT_FALSE(is_gross(0.19, 0.01, logged));
  EXPECT_TRUE(is_gross(-0.21, 0.01, logged));
  EXPECT_FALSE(is_gross(-0.5, 0.2, logged));
  EXPECT_TRUE(is_gross(std::log(3.6), 0.2, logged));
  EXPECT_TRUE(is_gross(std::nan(""), 0.2, logged));
  EXPECT_TRUE(is_gross(std::log(0.0), 0.2, logged));
}

}  // namespace
}  // namespace groundscale
