#include "groundscale/calibration/clock_offset.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/calibration/test_drive_internal.hpp"

namespace groundscale {
namespace {

using internal::TestDrive;
using testing::HasSubstr;

TEST(ClockOffset, IsFoundToASmallPartOfTheLogsInterval) {
  for (const double ahead_s : {-17.35, 0.0, 3.0, 41.2}) {
    for (const double interval_s : {0.02, 1.0, 2.0}) {
      TestDrive drive;
      drive.clock_ahead_s = ahead_s;
      drive.log_interval_s = interval_s;
      Rng rng(7);
      const Odometer odometer = drive.odometer(rng);
      const auto clock = find_clock_offset(drive.log(rng), odometer, {});
      ASSERT_TRUE(clock) << clock.error().message;
      EXPECT_TRUE(clock->found);
      EXPECT_FALSE(clock->aligned);
      EXPECT_NEAR(clock->offset_s, ahead_s, 0.1 + 0.05 * interval_s) << interval_s;
      EXPECT_LT(clock->sd_s, 0.3);
    }
  }
}

TEST(ClockOffset, OutliersOfTheLogChangeNothing) {
  TestDrive drive;
  Rng rng(8);
  const Odometer odometer = drive.odometer(rng);
  auto samples = drive.samples(rng);
  for (std::size_t k = 5; k < samples.size(); k += 13) samples[k].speed_mps = 40.0;
  const auto clock = find_clock_offset(SpeedLog::create(samples).value(), odometer, {});
  ASSERT_TRUE(clock) << clock.error().message;
  EXPECT_NEAR(clock->offset_s, drive.clock_ahead_s, 0.2);
}

TEST(ClockOffset, AnotherClockIsAlignedByTheStarts) {
  TestDrive drive;
  drive.clock_ahead_s = 1777638896.0;
  drive.log_starts_s = 12.3;
  Rng rng(9);
  const Odometer odometer = drive.odometer(rng);
  const auto clock = find_clock_offset(drive.log(rng), odometer, {});
  ASSERT_TRUE(clock) << clock.error().message;
  EXPECT_TRUE(clock->aligned);
  EXPECT_NEAR(clock->offset_s - drive.clock_ahead_s, 0.0, 0.15);
}

TEST(ClockOffset, ALogLongerThanTheVideoIsSearchedAsFarAsIsAsked) {
  TestDrive whole;
  whole.duration_s = 900.0;
  whole.speed_mps = [](double t) { return 9.0 + 3.0 * std::sin(0.21 * t) + 2.0 * std::sin(0.0137 * t * std::sqrt(t)); };
  Rng rng(10);
  TestDrive part = whole;  // the video is 80 s of it
  part.duration_s = 80.0;
  part.speed_mps = [&whole](double t) { return whole.speed_mps(t + 500.0); };
  const Odometer odometer = part.odometer(rng);
  const auto clock = find_clock_offset(whole.log(rng), odometer, {.max_offset_s = 900.0});
  ASSERT_TRUE(clock) << clock.error().message;
  EXPECT_NEAR(clock->offset_s, 503.0, 0.2);
}

TEST(ClockOffset, IsNotFoundAtConstantSpeed) {
  TestDrive drive;
  drive.speed_mps = [](double) { return 11.0; };
  Rng rng(11);
  const Odometer odometer = drive.odometer(rng);
  const auto clock = find_clock_offset(drive.log(rng), odometer, {});
  ASSERT_TRUE(clock) << clock.error().message;
  EXPECT_FALSE(clock->found);
  EXPECT_GT(clock->sd_s, 1.0);
  EXPECT_GT(clock->candidates.size(), 10U);
  double sum = 0.0;
  for (const ClockOffset::Candidate& candidate : clock->candidates) sum += candidate.weight;
  EXPECT_NEAR(sum, 1.0, 1e-9);
}

TEST(ClockOffset, AGivenOneIsTaken) {
  TestDrive drive;
  Rng rng(12);
  const Odometer odometer = drive.odometer(rng);
  const auto clock = find_clock_offset(drive.log(rng), odometer, {.offset_s = 3.0});
  ASSERT_TRUE(clock) << clock.error().message;
  EXPECT_TRUE(clock->given);
  EXPECT_EQ(clock->offset_s, 3.0);
  EXPECT_NEAR(clock->noise.log_mps, 0.15, 0.1);  // of means of two samples, and what the odometry adds
}

std::string refusal(const TestDrive& drive, const ClockSearch& search) {
  Rng rng(13);
  const Odometer odometer = drive.odometer(rng);
  const auto clock = find_clock_offset(drive.log(rng), odometer, search);
  return clock ? "" : clock.error().message;
}

TEST(ClockOffset, SaysWhenLogAndVideoHaveTooLittleInCommon) {
  TestDrive drive;
  drive.clock_ahead_s = 300.0;
  EXPECT_THAT(refusal(drive, {}),
              HasSubstr("the log doesn't overlap the video: it goes from 300.3 to 419.3 s, the video "
                        "from 0.0 to 120.0 s"));
  EXPECT_THAT(refusal(drive, {.offset_s = 200.0}), testing::IsEmpty());
  EXPECT_THAT(refusal(drive, {.offset_s = 185.0}), HasSubstr("have 4 s in common"));
  drive.clock_ahead_s = 3.0;
  drive.log_ends_s = 8.0;
  EXPECT_THAT(refusal(drive, {}), HasSubstr("have 7 s in common at most"));
}

TEST(ClockOffset, SaysWhenTheRangeIsTooSmall) {
  TestDrive drive;
  drive.clock_ahead_s = 5.0;
  EXPECT_THAT(refusal(drive, {.max_offset_s = 4.0}), HasSubstr("at the end of the range"));
  EXPECT_EQ(refusal(drive, {.max_offset_s = 6.0}), "");
}

}  // namespace
}  // namespace groundscale
