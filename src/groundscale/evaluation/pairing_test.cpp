#include "groundscale/evaluation/pairing.hpp"

#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/evaluation/test_drives_internal.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"

namespace groundscale {
namespace {

using internal::straight_drive;
using internal::TempFolder;
using internal::with_times;
using testing::ElementsAre;
using testing::HasSubstr;

std::string kitti_rows(const Trajectory& drive) {
  std::string text;
  for (const RigidTransform& pose : drive.world_from_cam) text += kitti_row(pose) + "\n";
  return text;
}

std::string tum_rows(const Trajectory& drive, double shift_s = 0.0) {
  std::string text;
  for (int k = 0; k < drive.size(); ++k) text += tum_row(drive.times_s[k] + shift_s, drive.world_from_cam[k]) + "\n";
  return text;
}

/// A run of `rows` frames from `first_frame` on.
void write_run(const TempFolder& folder, int first_frame, int rows, bool times = true) {
  folder.file("run/trajectory.kitti", kitti_rows(straight_drive(rows, 1.0)));
  std::string csv = "frame,time_s,step_sd_m,online_step_m,raw_step_m,raw_step_sd_m,reason\n";
  for (int frame = first_frame; frame < first_frame + rows; ++frame) {
    csv += fmt::format("{},{},,,,,\n", frame, times ? fmt::format("{}", 0.1 * frame) : "");
  }
  folder.file("run/frames.csv", csv);
}

std::string error_of(const PairingRequest& request) {
  const auto drive = pair_drive(request);
  if (drive) return "no error";
  EXPECT_EQ(drive.error().code, ErrorCode::kBadInput);
  return drive.error().message;
}

PairedDrive pair_or_fail(const PairingRequest& request) {
  const auto drive = pair_drive(request);
  EXPECT_TRUE(drive) << (drive ? "" : drive.error().message);
  return drive ? *drive : PairedDrive{};
}

class Pairing : public testing::Test {
 protected:
  TempFolder folder;
  std::string kitti_truth = folder.file("truth/poses.txt", kitti_rows(straight_drive(20, 1.0)));
};

TEST_F(Pairing, RowOfAKittiFileIsThatOfTheTruthPlusTheOffsetAndSkippedRowsAreGone) {
  const std::string estimate = folder.file("estimate.kitti", kitti_rows(straight_drive(5, 1.0)));
  EXPECT_THAT(pair_or_fail({estimate, kitti_truth, 0, 0}).truth_rows, ElementsAre(0, 1, 2, 3, 4));
  const PairedDrive drive = pair_or_fail({estimate, kitti_truth, 10, 2});
  EXPECT_THAT(drive.truth_rows, ElementsAre(12, 13, 14));
  EXPECT_EQ(drive.estimate.size(), 3);
  EXPECT_EQ(drive.estimate.world_from_cam[0].translation.z(), 2.0);
  EXPECT_EQ(drive.truth.world_from_cam[0].translation.z(), 12.0);
  EXPECT_EQ(drive.rows_of_truth, 20);
  EXPECT_FALSE(drive.truth.has_times());
}

TEST_F(Pairing, RowsWithoutAPartnerAreAnErrorThatNamesBothCountsNeverACut) {
  const std::string estimate = folder.file("estimate.kitti", kitti_rows(straight_drive(5, 1.0)));
  EXPECT_THAT(error_of({estimate, kitti_truth, 16, 0}),
              AllOf(HasSubstr("needs rows 16 to 20 of the truth"), HasSubstr("has 20 rows (0 to 19)")));
  EXPECT_THAT(error_of({estimate, kitti_truth, -1, 0}), HasSubstr("needs rows -1 to 3"));
  EXPECT_THAT(pair_or_fail({estimate, kitti_truth, -1, 1}).truth_rows, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(error_of({estimate, kitti_truth, 0, 4}), HasSubstr("5 rows, of which 4 are skipped"));
  EXPECT_THAT(error_of({estimate, kitti_truth, 0, -1}), HasSubstr("--skip -1"));
}

TEST_F(Pairing, ARunsFolderKnowsItsFrameNumbersAndTimes) {
  write_run(folder, 15, 4);
  const PairedDrive drive = pair_or_fail({folder / "run", kitti_truth, 0, 1});
  EXPECT_THAT(drive.truth_rows, ElementsAre(16, 17, 18));
  EXPECT_EQ(drive.frames.front().frame, 16);
  ASSERT_TRUE(drive.truth.has_times());
  EXPECT_NEAR(drive.truth.times_s.front(), 1.6, 1e-12);
  EXPECT_EQ(drive.times_from, folder / "run/frames.csv");
  EXPECT_THAT(pair_or_fail({folder / "run", kitti_truth, -15, 0}).truth_rows, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(error_of({folder / "run", kitti_truth, 2, 0}), HasSubstr("needs rows 17 to 20"));
}

TEST_F(Pairing, ARunWithoutTimesHasNone) {
  write_run(folder, 0, 4, false);
  EXPECT_FALSE(pair_or_fail({folder / "run", kitti_truth, 0, 0}).truth.has_times());
}

TEST_F(Pairing, ARunsOnlineTrajectoryIsCutLikeTheFinalOne) {
  write_run(folder, 0, 4);
  folder.file("run/online.kitti", kitti_rows(straight_drive(4, 1.1)));
  const PairedDrive drive = pair_or_fail({folder / "run", kitti_truth, 0, 1});
  ASSERT_TRUE(drive.online);
  EXPECT_EQ(drive.online->size(), 3);
  EXPECT_NEAR(drive.online->world_from_cam[0].translation.z(), 1.1, 1e-12);
}

TEST_F(Pairing, AFolderOfARunThatDidNotEndOrIsMixedUpIsRefused) {
  folder.file("run/online.kitti", kitti_rows(straight_drive(4, 1.1)));
  EXPECT_THAT(error_of({folder / "run", kitti_truth, 0, 0}),
              AllOf(HasSubstr("trajectory.kitti: not there"), HasSubstr("online.kitti can be evaluated by itself")));
  write_run(folder, 0, 5);
  EXPECT_THAT(error_of({folder / "run", kitti_truth, 0, 0}), AllOf(HasSubstr("has 5 rows"), HasSubstr("has 4")));
  std::filesystem::remove(folder / "run/online.kitti");
  folder.file("run/trajectory.kitti", kitti_rows(straight_drive(6, 1.0)));
  EXPECT_THAT(error_of({folder / "run", kitti_truth, 0, 0}), AllOf(HasSubstr("has 6 rows"), HasSubstr("has 5")));
}

TEST_F(Pairing, TumRowsMeetTheNearestOfTheTruthInTime) {
  Trajectory sparse = with_times(straight_drive(4, 2.0), 0.2);  // every second row of the truth
  const std::string estimate = folder.file("estimate.tum", tum_rows(sparse, 0.515));
  const std::string truth = folder.file("truth.tum", tum_rows(with_times(straight_drive(20, 1.0), 0.1)));
  const PairedDrive drive = pair_or_fail({estimate, truth, 0, 0});
  EXPECT_THAT(drive.truth_rows, ElementsAre(5, 7, 9, 11));
  EXPECT_NEAR(*drive.max_time_difference_s, 0.015, 1e-12);
  EXPECT_EQ(drive.times_from, truth);
  EXPECT_THAT(pair_or_fail({estimate, truth, 0, 2}).truth_rows, ElementsAre(9, 11));
}

TEST_F(Pairing, TumRowsFarFromTheTruthInTimeAreAnErrorThatNamesBothTimes) {
  const std::string truth = folder.file("truth.tum", tum_rows(with_times(straight_drive(6, 1.0), 0.1)));
  const auto error_with = [&](double shift_s, double interval_s) {
    const Trajectory drive = with_times(straight_drive(4, 1.0), interval_s);
    return error_of({folder.file("estimate.tum", tum_rows(drive, shift_s)), truth, 0, 0});
  };
  EXPECT_THAT(error_with(0.25, 0.125), AllOf(HasSubstr("pose 1 is at 0.25 s"), HasSubstr("at most 0.02 s")));
  EXPECT_THAT(error_with(0.5, 0.1), HasSubstr("pose 2 is at 0.6 s"));
  EXPECT_THAT(error_with(-0.1, 0.1), HasSubstr("pose 1 is at -0.1 s"));
  EXPECT_THAT(error_with(0.1, 0.015), HasSubstr("same nearest pose of the truth"));
  const std::string estimate = folder.file("e.tum", tum_rows(with_times(straight_drive(4, 1.0), 0.1)));
  EXPECT_THAT(error_of({estimate, truth, 1, 0}), HasSubstr("matched by time"));
}

TEST_F(Pairing, TumRowsAgainstAKittiTruthNeedTheTimesBesideIt) {
  const std::string estimate = folder.file("estimate.tum", tum_rows(with_times(straight_drive(4, 1.0), 0.1), 0.3));
  EXPECT_THAT(error_of({estimate, kitti_truth, 0, 0}), HasSubstr("truth/times.txt isn't there"));
  std::string times;
  for (int row = 0; row < 20; ++row) times += fmt::format("{:e}\n", 0.1 * row);
  folder.file("truth/times.txt", times);
  EXPECT_THAT(pair_or_fail({estimate, kitti_truth, 0, 0}).truth_rows, ElementsAre(3, 4, 5, 6));
  folder.file("truth/times.txt", "0\n0.1\n");
  EXPECT_THAT(error_of({estimate, kitti_truth, 0, 0}), AllOf(HasSubstr("has 2 times"), HasSubstr("has 20 rows")));
  folder.file("truth/times.txt", "0\n0.2\n0.1\n");
  EXPECT_THAT(error_of({estimate, kitti_truth, 0, 0}), HasSubstr("times.txt:3"));
}

TEST_F(Pairing, TimesBesideAKittiTruthAreLeftAloneForKittiRows) {
  folder.file("truth/times.txt", "0\n0.1\n");
  const std::string estimate = folder.file("estimate.kitti", kitti_rows(straight_drive(5, 1.0)));
  EXPECT_FALSE(pair_or_fail({estimate, kitti_truth, 0, 0}).truth.has_times());
}

TEST_F(Pairing, AKittiEstimateTakesTheTimesOfATumTruth) {
  const std::string truth = folder.file("truth.tum", tum_rows(with_times(straight_drive(6, 1.0), 0.1)));
  const std::string estimate = folder.file("estimate.kitti", kitti_rows(straight_drive(5, 1.0)));
  const PairedDrive drive = pair_or_fail({estimate, truth, 1, 0});
  EXPECT_THAT(drive.truth_rows, ElementsAre(1, 2, 3, 4, 5));
  EXPECT_EQ(drive.times_from, truth);
  EXPECT_FALSE(drive.max_time_difference_s);
}

}  // namespace
}  // namespace groundscale
