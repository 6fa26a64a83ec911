#include "groundscale/odometry/speed_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace groundscale {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// 10 m/s from 50 to 60 s by the log's clock, which is 50 s ahead.
SpeedReference reference_of(const std::vector<double>& times_s = {50, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60}) {
  std::vector<SpeedSample> samples;
  for (const double time_s : times_s) samples.push_back({time_s, 10.0});
  return {SpeedLog::create(std::move(samples)).value(), {.file = "speed.csv", .offset_s = 50.0}};
}

/// 10 Hz from 0 to 5 s, all accepted or none.
std::vector<FrameResult> drive(bool accepted = true) {
  std::vector<FrameResult> results;
  for (int k = 0; k <= 50; ++k) {
    FrameResult result;
    result.time_s = 0.1 * k;
    result.scaled = true;
    result.reason = accepted ? "" : "nothing seen";
    result.raw_over_online = 1.0;
    results.push_back(result);
  }
  return results;
}

SpeedReference compared(double ratio, int steps = 60) {
  SpeedReference speed = reference_of();
  for (int k = 0; k < steps; ++k) speed.compare({ratio, 0.1}, 1.0);
  return speed;
}

TEST(SpeedCheck, LogAndDriveMustHaveTimeInCommon) {
  EXPECT_TRUE(check_overlap(reference_of(), {0.0, 5.0}));
  EXPECT_TRUE(check_overlap(reference_of(), {9.0, 15.0}));
  const auto later = check_overlap(reference_of(), {10.5, 15.0});
  ASSERT_FALSE(later);
  EXPECT_EQ(later.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(later.error().message,
            "scale.speed: speed.csv: the log doesn't overlap the drive: it goes from 0.0 to 10.0 s by the video's "
            "clock, the drive from 10.5 to 15.0 s (scale.speed_offset_s, by how much the log's clock is ahead, is 50)");
}

TEST(SpeedCheck, NothingIsSaidOfALogThatFits) {
  EXPECT_THAT(speed_warnings(reference_of(), drive()), IsEmpty());
  EXPECT_THAT(speed_warnings(compared(1.03), drive()), IsEmpty());
  EXPECT_THAT(speed_warnings(compared(1.1, 20), drive()), IsEmpty());  // two seconds may be off by so much
}

TEST(SpeedCheck, GapsAndEndsAreNamed) {
  EXPECT_THAT(speed_warnings(reference_of({50, 51, 54, 55, 56, 57}), drive()),
              ElementsAre("scale.speed: the log knows nothing of 30 of 50 frames; the first of 1 gaps in the drive is "
                          "from 1.0 to 4.0 s by the video's clock"));
  EXPECT_THAT(speed_warnings(reference_of({52, 53, 54, 55, 56}), drive()),
              ElementsAre(HasSubstr("knows nothing of 20 of 50 frames: it goes from 2.0 to 6.0 s")));
  EXPECT_THAT(speed_warnings(reference_of({60, 61, 62, 63, 64}), drive()),
              ElementsAre(HasSubstr("doesn't overlap the drive: it goes from 10.0 to 14.0 s")));
}

TEST(SpeedCheck, SpeedsThatDifferFromTheGroundsAreNamedWithTheirUnit) {
  EXPECT_THAT(speed_warnings(compared(0.9), drive()), ElementsAre(HasSubstr("are 10.0 % below those by the ground")));
  EXPECT_THAT(speed_warnings(compared(3.55), drive()),
              ElementsAre(AllOf(HasSubstr("3.55 times those by the ground"), HasSubstr("are they in km/h?"))));
  EXPECT_THAT(speed_warnings(compared(1.6), drive()), ElementsAre(HasSubstr("is the log of this drive")));
}

TEST(SpeedCheck, AScaleThatIsTheLogsAloneIsNamed) {
  EXPECT_THAT(speed_warnings(reference_of(), drive(false)),
              ElementsAre(HasSubstr("the scale is the speed log's alone")));
}

}  // namespace
}  // namespace groundscale
