#include "groundscale/report/sample_frames.hpp"

#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/core/rng.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::Contains;
using testing::ElementsAre;

FrameResult measured(int frame, double raw_over_online = 1.0) {
  FrameResult result;
  result.frame = frame;
  result.state = FrameState::kMoving;
  result.scaled = true;
  result.online_step_m = 1.0;
  result.online_step_sd = 0.03;
  result.raw_over_online = raw_over_online;
  result.raw_sd = 0.04;
  return result;
}

/// A drive whose pictures are the frames' numbers.
class Drive {
 public:
  explicit Drive(int frames) : samples(frames) {}
  void take(const FrameResult& result, std::optional<double> true_step_m = std::nullopt) {
    samples.take(result, true_step_m, [&] {
      ++put_aside;
      return [frame = result.frame] { return fmt::to_string(frame); };
    });
  }
  std::vector<int> frames(const std::string& why) const {
    std::vector<int> numbers;
    for (const SampleFrame& sample : samples.chosen()) {
      EXPECT_EQ(sample.picture, fmt::to_string(sample.frame));
      if (sample.why == why) numbers.push_back(sample.frame);
    }
    return numbers;
  }
  SampleFrames samples;
  int put_aside = 0;
};

TEST(SampleFrames, ShowsTheFarthestFromTheFilteredStepInStandardDeviations) {
  Drive drive(400);
  for (int k = 0; k < 400; ++k) {
    FrameResult result = measured(k, k == 77 || k == 78 || k == 205 ? 1.3 : k == 310 ? 0.8 : 1.01);
    // The largest deviation of all is an uncertain one.
    if (k == 150) {
      result.raw_over_online = 1.5;
      result.raw_sd = 2.0;
    }
    drive.take(result);
  }
  EXPECT_THAT(drive.frames("deviation"), ElementsAre(77, 205, 310));
  ASSERT_EQ(drive.samples.chosen().size(), 8U);
  for (const SampleFrame& sample : drive.samples.chosen()) {
    if (sample.frame != 205) continue;
    EXPECT_NEAR(sample.value, std::log(1.3) / 0.05, 1e-9);
  }
}

TEST(SampleFrames, ShowsTheFarthestFromTheTruthWhereThereIsOne) {
  Drive drive(400);
  for (int k = 0; k < 400; ++k) {
    double true_step_m = 1.01;
    if (k == 60) true_step_m = 1.4;
    if (k == 200) true_step_m = 0.7;
    if (k == 333) true_step_m = 1.2;
    if (k == 250) true_step_m = 0.1;  // as good as standing: says nothing
    // Measurements far off don't count then.
    drive.take(measured(k, k == 120 ? 2.0 : 1.0), true_step_m);
  }
  EXPECT_THAT(drive.frames("error"), ElementsAre(60, 200, 333));
}

TEST(SampleFrames, StepsWithoutScaleAreNoErrorsYet) {
  Drive drive(40);
  for (int k = 0; k < 40; ++k) {
    FrameResult result = measured(k);
    result.scaled = false;
    drive.take(result, 3.0);
  }
  EXPECT_THAT(drive.frames("error"), ElementsAre());
  EXPECT_EQ(drive.frames("spread").size(), 8U);
}

TEST(SampleFrames, ShowsOneOfEachOfTheTwoCommonestRefusals) {
  Drive drive(300);
  for (int k = 0; k < 300; ++k) {
    FrameResult result = measured(k);
    if (k == 0) result.reason = "first frame";
    if (k > 100 && k < 120) result.reason = fmt::format("normal is {:.1f} deg off", 0.1 * k);
    if (k > 200 && k < 250) result.reason = fmt::format("speed {:.2f} m/s is too low", 0.01 * k);
    if (k == 280) result.reason = "rare";
    if (k > 290) {
      result.state = FrameState::kStill;
      result.reason = "standing still";
    }
    drive.take(result);
  }
  EXPECT_THAT(drive.frames("refused"), ElementsAre(102, 202));
}

TEST(SampleFrames, OthersAreSpreadEvenly) {
  Drive drive(800);
  for (int k = 0; k < 800; ++k) {
    FrameResult result = measured(k + 1000);
    result.raw_over_online.reset();
    drive.take(result);
  }
  EXPECT_THAT(drive.frames("spread"), ElementsAre(1050, 1150, 1250, 1350, 1450, 1550, 1650, 1750));
}

TEST(SampleFrames, AShortDriveShowsEachFrameOnce) {
  Drive drive(5);
  for (int k = 0; k < 5; ++k) drive.take(measured(k, 1.0 + 0.1 * k));
  std::vector<int> numbers;
  for (const SampleFrame& sample : drive.samples.chosen()) numbers.push_back(sample.frame);
  EXPECT_THAT(numbers, ElementsAre(0, 1, 2, 3, 4));
}

TEST(SampleFrames, PutsFewFramesOfALongDriveAside) {
  Rng rng(1);
  Drive drive(4000);
  for (int k = 0; k < 4000; ++k) drive.take(measured(k, std::exp(0.05 * rng.normal())));
  // 8 spread and some tens while the largest of normal errors are found; every frame is one in 4000.
  EXPECT_LE(drive.put_aside, 60);
  EXPECT_EQ(drive.samples.chosen().size(), 8U);
}

TEST(SampleFrames, ErrorsThatGrowAllTheTimeAreHeldWithinBounds) {
  Drive drive(4000);
  for (int k = 0; k < 4000; ++k) drive.take(measured(k, std::exp(0.001 * k)));
  // From 0.02 to 80 sd in steps of a tenth: log(4000) / log(1.1) = 87 for each of the four places at most.
  EXPECT_LE(drive.put_aside, 4 * 87 + 8);
  EXPECT_THAT(drive.frames("deviation"), Contains(testing::Ge(3600)));
}

TEST(KindOfReason, LeavesOutNumbersAlone) {
  EXPECT_EQ(kind_of_reason("speed 0.31 m/s is too low"), "speed ... m/s is too low");
  EXPECT_EQ(kind_of_reason("12 road points on the path, 20 are needed"), "... road points on the path, ... are needed");
  EXPECT_EQ(kind_of_reason("sd of -1.5 % x2 is 3."), "sd of ... % x2 is ....");
  EXPECT_EQ(kind_of_reason("standing still"), "standing still");
  EXPECT_EQ(kind_of_reason(""), "");
}

TEST(Samples, AreReadAsTheyWereWritten) {
  const TempFolder folder;
  const std::string samples = folder / "samples";
  ASSERT_TRUE(write_samples(
      samples, {{3, "error", 0.25, std::string("a\0b", 3)}, {12, "spread", 0.0, ""}, {99, "refused", 0.0, "c"}}));
  const auto read = read_samples(samples);
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->size(), 2U);  // one had no picture
  EXPECT_EQ(read->front().frame, 3);
  EXPECT_EQ(read->front().why, "error");
  EXPECT_EQ(read->front().value, 0.25);
  EXPECT_EQ(read->front().picture, std::string("a\0b", 3));
  std::filesystem::remove(folder / "samples/000099.jpg");
  EXPECT_EQ(read_samples(samples)->back().picture, "");
}

TEST(Samples, AreNoneWithoutTheirTableAndAnErrorWithAnother) {
  const TempFolder folder;
  EXPECT_TRUE(read_samples(folder.path())->empty());
  folder.file("samples.csv", "frame,why,value,picture\nx,error,1,../secret.jpg\n");
  const auto read = read_samples(folder.path());
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(read.error().message,
              testing::EndsWith("samples.csv:2: must be frame,why,value,picture, as run writes it"));
}

}  // namespace
}  // namespace groundscale
