#include "groundscale/calibration/camera_height.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/calibration/test_drive_internal.hpp"

namespace groundscale {
namespace {

using internal::TestDrive;
using testing::HasSubstr;

constexpr StartHeight kStart{.height_m = 1.5, .known = false};

Result<SpeedHeight> height_of(const TestDrive& drive, std::uint64_t seed, const StartHeight& start = kStart,
                              const HeightOptions& options = {}) {
  Rng rng(seed);
  const Odometer odometer = drive.odometer(rng);
  return height_from_speed(drive.log(rng), odometer, start, {}, options);
}

std::string refusal(const Result<SpeedHeight>& height) { return height ? "" : height.error().message; }

TEST(CameraHeight, IsTheStartsTimesTheRatioOfSpeeds) {
  TestDrive drive;
  drive.log_noise_mps = 0.01;
  drive.step_noise = 0.0;
  const auto found = height_of(drive, 1);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_NEAR(found->height.height_m, 1.65, 0.002);
  EXPECT_NEAR(found->clock.offset_s, 3.0, 0.05);
  EXPECT_LT(found->height.ratio_sd, 0.002);
  EXPECT_GE(found->height.height_sd_m, 0.005 * 1.65);  // the odometry's own, which no log tells
  EXPECT_LT(found->scatter, 0.01);
  EXPECT_GT(found->compared_s, 80.0);
  EXPECT_GT(found->slow_s, 8.0);
}

/// 2 sd hold about 95 %: over 200 seeds 95 +- 1.5 % if errors are as told.
struct Coverage {
  int within = 0;
  double square = 0.0;
  double mean_sd = 0.0;
};

Coverage coverage_of(const TestDrive& drive, int seeds) {
  Coverage coverage;
  for (int seed = 0; seed < seeds; ++seed) {
    const auto found =
        height_of(drive, static_cast<std::uint64_t>(100 + seed), kStart, {.model_sd = 0.0, .max_sd = 1.0});
    EXPECT_TRUE(found) << seed << found.error().message;
    if (!found) continue;
    const double error = (found->height.ratio - drive.ratio) / found->height.ratio_sd;
    coverage.within += std::abs(error) < 2.0 ? 1 : 0;
    coverage.square += error * error / seeds;
    coverage.mean_sd += found->height.ratio_sd / seeds;
  }
  return coverage;
}

TEST(CameraHeight, UncertaintyHoldsWhatItSays) {
  constexpr int kSeeds = 100;
  TestDrive drive;
  const Coverage minutes = coverage_of(drive, kSeeds);
  RecordProperty("within", minutes.within);
  EXPECT_GE(minutes.within, 90);
  EXPECT_LT(minutes.mean_sd, 0.01);
  EXPECT_GT(minutes.square, 0.4);  // nor is it larger than it need be
  drive.duration_s = 30.0;
  const Coverage short_drive = coverage_of(drive, kSeeds);
  EXPECT_GE(short_drive.within, 90);
  EXPECT_GT(short_drive.mean_sd, minutes.mean_sd);
}

TEST(CameraHeight, WithoutAnOffsetItsUncertaintyEnters) {
  TestDrive drive;
  drive.duration_s = 60.0;
  // Slowly faster: without the offset the ratio isn't known, and no offset fits better than another.
  drive.speed_mps = [](double t) { return 8.0 * std::exp(0.004 * t); };
  const auto blind = height_of(drive, 3, kStart, {.max_sd = 1.0});
  ASSERT_TRUE(blind) << blind.error().message;
  ASSERT_FALSE(blind->clock.found);
  EXPECT_GT(blind->offset_sd_s, 1.0);
  EXPECT_GT(blind->height.ratio_sd, 0.02);
  EXPECT_LT(std::abs(blind->height.ratio - drive.ratio), 3.0 * blind->height.ratio_sd);
  Rng rng(3);
  const Odometer odometer = drive.odometer(rng);
  const auto told = height_from_speed(drive.log(rng), odometer, kStart, {.offset_s = 3.0});
  ASSERT_TRUE(told) << told.error().message;
  EXPECT_LT(told->height.ratio_sd, 0.01);
  EXPECT_EQ(told->offset_sd_s, 0.0);
}

TEST(CameraHeight, GapsOfTheLogArePassedOver) {
  TestDrive drive;
  Rng rng(4);
  const Odometer odometer = drive.odometer(rng);
  auto samples = drive.samples(rng);
  samples.erase(samples.begin() + 60, samples.begin() + 80);
  const auto found = height_from_speed(SpeedLog::create(samples).value(), odometer, kStart, {});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_NEAR(found->height.ratio, drive.ratio, 3.0 * found->height.ratio_sd);
  EXPECT_LT(found->compared_s + found->slow_s, 100.0);
}

TEST(CameraHeight, KilometresAnHourAreNamed) {
  TestDrive drive;
  drive.ratio = 3.6;
  EXPECT_THAT(refusal(height_of(drive, 5)), HasSubstr("the camera would be 5.4"));
  EXPECT_THAT(refusal(height_of(drive, 5)), HasSubstr("are they in km/h? Then it is 1.50 m"));
  const StartHeight known{.height_m = 1.65, .known = true};
  EXPECT_THAT(refusal(height_of(drive, 5, known)), HasSubstr("are they in km/h? Then it is 1.6"));
  drive.ratio = 2.2369;
  EXPECT_THAT(refusal(height_of(drive, 5, known)), HasSubstr("are they in mph? Then it is 1.6"));
  drive.ratio = 0.1;
  EXPECT_THAT(refusal(height_of(drive, 5)), HasSubstr("are they in m/s, and of this drive?"));
}

TEST(CameraHeight, StandingStillIsNoDrive) {
  TestDrive still;
  still.speed_mps = [](double) { return 0.0; };
  EXPECT_THAT(refusal(height_of(still, 6)), HasSubstr("the log stands still"));
  TestDrive drive;
  Rng rng(6);
  const Odometer odometer = still.odometer(rng);
  EXPECT_THAT(refusal(height_from_speed(drive.log(rng), odometer, kStart, {})), HasSubstr("the camera stands still"));
}

TEST(CameraHeight, IsRefusedWhereBlocksContradictOneAnother) {
  TestDrive drive;
  Rng rng(7);
  const Odometer odometer = drive.odometer(rng);
  auto samples = drive.samples(rng);
  for (SpeedSample& sample : samples) sample.speed_mps *= sample.time_s < 60.0 ? 1.0 : 1.3;
  const auto found = height_from_speed(SpeedLog::create(samples).value(), odometer, kStart, {});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kNotConverged);
  EXPECT_THAT(found.error().message, HasSubstr("isn't one number"));
}

TEST(CameraHeight, IsRefusedWhereItIsTooUncertain) {
  TestDrive drive;
  drive.duration_s = 25.0;
  drive.log_noise_mps = 4.0;
  const auto found = height_of(drive, 9, kStart, {.max_scatter = 1.0, .max_sd = 0.05});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kNotConverged);
  EXPECT_THAT(found.error().message,
              testing::ContainsRegex("the height would be .* m with a standard deviation of [0-9]+ %: "));
}

TEST(CameraHeight, IsRefusedWhereTheLogIsOfAnotherDrive) {
  TestDrive drive;
  TestDrive other;
  other.speed_mps = [](double t) { return 9.0 + 4.0 * std::sin(0.33 * t) * std::sin(0.071 * t * t / 20.0); };
  Rng rng(8);
  const Odometer odometer = drive.odometer(rng);
  const auto found = height_from_speed(other.log(rng), odometer, kStart, {});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kNotConverged);
}

/// Twenty seconds at 8 m/s true, measured 1.5 % short with a road that undulates.
std::vector<FrameResult> results_of_a_drive() {
  std::vector<FrameResult> results(201);
  for (std::size_t k = 0; k < results.size(); ++k) {
    FrameResult& r = results[k];
    r.time_s = 0.1 * static_cast<double>(k);
    r.state = FrameState::kMoving;
    r.scaled = true;
    r.step_m = r.online_step_m = k == 0 ? 0.0 : 0.8 / 1.015;
    if (k > 0) r.raw_over_online = 1.0 + 0.02 * std::sin(0.1 * static_cast<double>(k));
  }
  return results;
}

TEST(CameraHeight, OfAKnownDistance) {
  const auto results = results_of_a_drive();
  const auto whole = height_from_distance({.distance_m = 160.0}, results, kStart);
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_NEAR(whole->height_m, 1.5 * 1.015, 1e-9);
  EXPECT_GT(whole->height_sd_m, 0.005 * 1.5);
  EXPECT_LT(whole->height_sd_m, 0.03 * 1.5);
  const auto part =
      height_from_distance({.distance_m = 40.0, .distance_sd_m = 2.0, .from_s = 5.0, .to_s = 10.0}, results, kStart);
  ASSERT_TRUE(part) << part.error().message;
  EXPECT_NEAR(part->height_m, 1.5 * 1.015, 1e-9);
  EXPECT_GT(part->height_sd_m, 0.05 * 1.5);  // the 2 m in 40
}

TEST(CameraHeight, OfADistanceThatCanNotBe) {
  auto results = results_of_a_drive();
  const auto refusal_of = [&results](const KnownDistance& known) {
    const auto height = height_from_distance(known, results, kStart);
    return height ? "" : height.error().message;
  };
  EXPECT_THAT(refusal_of({.distance_m = 40.0, .from_s = 5.0, .to_s = 30.0}),
              HasSubstr("but the video goes from 0 to 20 s"));
  EXPECT_THAT(refusal_of({.distance_m = 40.0, .from_s = 5.0, .to_s = 5.1}), HasSubstr("too little to compare with"));
  EXPECT_THAT(refusal_of({.distance_m = 1600.0}),
              HasSubstr("is the distance in metres, and that between these times?"));
  results[60].state = FrameState::kBridged;
  EXPECT_THAT(refusal_of({.distance_m = 160.0}), HasSubstr("0.1 s of the way between 0 and 20 s had to be bridged"));
}

}  // namespace
}  // namespace groundscale
