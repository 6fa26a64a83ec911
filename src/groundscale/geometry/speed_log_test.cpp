#include "groundscale/geometry/speed_log.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace groundscale {
namespace {

using testing::HasSubstr;

/// Speed rises by 1 m/s each second, so that the way from 0 to t is t^2 / 2.
std::vector<SpeedSample> rising(int count) {
  std::vector<SpeedSample> samples;
  for (int k = 0; k < count; ++k) samples.push_back({static_cast<double>(k), static_cast<double>(k)});
  return samples;
}

std::string refusal(std::vector<SpeedSample> samples) {
  const auto log = SpeedLog::create(std::move(samples));
  return log ? "" : log.error().message;
}

TEST(SpeedLog, IsLinearBetweenSamplesAndItsWayIsTheIntegral) {
  const SpeedLog log = SpeedLog::create(rising(9)).value();
  for (const double time_s : {0.0, 0.25, 1.0, 3.7, 8.0}) {
    EXPECT_NEAR(log.speed_at(time_s).value(), time_s, 1e-12);
    for (const double from_s : {0.0, 0.1, 1.0}) {
      if (from_s > time_s) continue;
      EXPECT_NEAR(log.distance_m(from_s, time_s).value(), 0.5 * (time_s * time_s - from_s * from_s), 1e-12);
    }
  }
  EXPECT_FALSE(log.speed_at(-0.1));
  EXPECT_FALSE(log.speed_at(8.1));
  EXPECT_FALSE(log.distance_m(7.0, 8.1));
  EXPECT_EQ(log.median_interval_s(), 1.0);
}

TEST(SpeedLog, NothingIsKnownInAGap) {
  auto samples = rising(12);
  samples.erase(samples.begin() + 4, samples.begin() + 7);  // 3 s, then 7 s
  samples.erase(samples.begin() + 5);                       // 7 s, then 9 s: one row is missing, no gap
  const SpeedLog log = SpeedLog::create(samples).value();
  ASSERT_EQ(log.gaps().size(), 1U);
  EXPECT_EQ(log.gaps().front().from_s, 3.0);
  EXPECT_EQ(log.gaps().front().to_s, 7.0);
  EXPECT_FALSE(log.speed_at(5.0));
  EXPECT_EQ(log.speed_at(3.0), 3.0);  // its ends are samples
  EXPECT_EQ(log.speed_at(7.0), 7.0);
  EXPECT_EQ(log.speed_at(8.0), 8.0);
  EXPECT_FALSE(log.distance_m(2.0, 8.0));
  EXPECT_FALSE(log.distance_m(3.0, 7.0));
  EXPECT_NEAR(log.distance_m(2.0, 3.0).value(), 2.5, 1e-12);
  EXPECT_NEAR(log.distance_m(7.0, 8.0).value(), 7.5, 1e-12);
  EXPECT_NEAR(log.distance_m(7.5, 8.0).value(), 0.5 * (64.0 - 56.25), 1e-12);
}

TEST(SpeedLog, ASampleMaySayThatThereIsAGapBeforeIt) {
  auto samples = rising(8);
  samples[3].after_gap = true;
  const SpeedLog log = SpeedLog::create(samples).value();
  EXPECT_FALSE(log.speed_at(2.5));
  EXPECT_FALSE(log.distance_m(1.0, 4.0));
  EXPECT_TRUE(log.distance_m(3.0, 6.0));
}

TEST(SpeedLog, RefusesWhatIsNoLogOfSpeeds) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto with = [](std::size_t at, SpeedSample sample) {
    auto samples = rising(8);
    samples[at] = sample;
    return samples;
  };
  EXPECT_THAT(refusal(with(2, {kNan, 1.0})), HasSubstr("sample 3: the time is nan"));
  EXPECT_THAT(refusal(with(2, {2.0, kNan})), HasSubstr("the speed is nan"));
  EXPECT_THAT(refusal(with(2, {2.0, -1.0})), HasSubstr("must not be negative"));
  EXPECT_THAT(refusal(with(2, {2.0, 130.0})), HasSubstr("is it in km/h?"));
  EXPECT_THAT(refusal(with(2, {1.0, 2.0})), HasSubstr("the time doesn't rise: 1 s, then 1 s"));
  EXPECT_THAT(refusal(rising(4)), HasSubstr("4 speeds, at least 5"));
  auto slow = rising(8);
  for (SpeedSample& sample : slow) sample.time_s *= 10.0;
  EXPECT_THAT(refusal(slow), HasSubstr("10 s apart"));
}

TEST(LikelyUnit, IsTheNearestOneWithinTwelvePercent) {
  EXPECT_STREQ(likely_unit(3.65)->name, "km/h");
  EXPECT_STREQ(likely_unit(3.3)->name, "feet a second");
  EXPECT_STREQ(likely_unit(2.1)->name, "mph");
  EXPECT_EQ(likely_unit(1.0), nullptr);
  EXPECT_EQ(likely_unit(2.7), nullptr);
}

}  // namespace
}  // namespace groundscale
