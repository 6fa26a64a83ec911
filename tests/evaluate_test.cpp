#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "program.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;

/// Straight ahead, KITTI rows.
std::string straight_rows(int rows, double step_m) {
  std::string text;
  for (int row = 0; row < rows; ++row)
    text += kitti_row({Eigen::Matrix3d::Identity(), {0.0, 0.0, step_m * row}}) + "\n";
  return text;
}

class EvaluateCommand : public testing::Test {
 protected:
  /// Wrong use or bad input: status 2, a reason on stderr, nothing on stdout.
  std::string refused(const std::vector<std::string>& arguments) {
    std::vector<std::string> all{"evaluate"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const ProgramRun run = run_program(all);
    EXPECT_EQ(run.status, 2) << run.out << run.err;
    EXPECT_THAT(run.out, IsEmpty());
    return run.err;
  }

  TempFolder folder;
  std::string truth = folder.file("truth.txt", straight_rows(250, 1.0));
  std::string estimate = folder.file("estimate.kitti", straight_rows(230, 1.02));
};

TEST_F(EvaluateCommand, PrintsTheFiguresWorkedOutByHandForAStraightPathTwoPercentTooLong) {
  const ProgramRun run = run_program({"evaluate", estimate, "--truth", truth});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_THAT(run.out, ContainsRegex("scale_bias +\\+2\\.000 % +229 steps"));
  EXPECT_THAT(run.out, ContainsRegex("length_ratio +1\\.02000 +229 steps"));
  EXPECT_THAT(run.out, ContainsRegex("t_rel_100m +2\\.0200 % +13 segments"));  // starts 0, 10, ..., 120
  EXPECT_THAT(run.out, ContainsRegex("t_rel_200m +2\\.0100 % +3 segments"));   // starts 0, 10, 20
  EXPECT_THAT(run.out, ContainsRegex("sim3_scale +0\\.98039 "));
}

TEST_F(EvaluateCommand, TakesOffsetSkipAndLengthsBeforeOrAfterTheEstimate) {
  const ProgramRun run = run_program(
      {"evaluate", "--lengths", "20,50", "--truth-offset", "20", "--skip", "30", estimate, "--truth", truth});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("rows 50 to 249 of 250"));
  EXPECT_THAT(run.out, ContainsRegex("t_rel_20m +2\\.1000 %"));  // 21 m over 20
  EXPECT_THAT(run.out, ContainsRegex("t_rel_50m +2\\.0400 %"));  // 51 m over 50
}

TEST_F(EvaluateCommand, WritesTheFiguresToAFileAsWell) {
  const ProgramRun run = run_program({"evaluate", estimate, "--truth", truth, "--json", folder / "figures.json"});
  EXPECT_EQ(run.status, 0) << run.err;
  const auto text = read_text(folder / "figures.json");
  ASSERT_TRUE(text);
  EXPECT_THAT(*text, ContainsRegex("\"t_rel_100m\": \\{\n *\"value\": 2\\.0"));
}

TEST_F(EvaluateCommand, ReadsARunsFolderWithItsOwnFrameNumbers) {
  folder.file("run/trajectory.kitti", straight_rows(4, 1.0));
  folder.file("run/online.kitti", straight_rows(4, 1.1));
  folder.file("run/frames.csv",
              "frame,time_s,state,step_m,step_sd_m,online_step_m,raw_step_m,raw_step_sd_m,pitch_deg,roll_deg,matches,"
              "road_matches,road_inliers,reason\n"
              "15,1.5,moving,,,,,,,,,,,\n"
              "16,1.6,moving,1,0.02,1.1,0.97,0.02,0.5,0.1,300,200,150,\n"
              "17,1.7,moving,1,0.02,1.1,1.30,0.02,0.5,0.1,300,200,150,normal\n"
              "18,1.8,moving,1,0.02,1.1,0.97,0.02,0.5,0.1,300,200,150,\n");
  const ProgramRun run = run_program({"evaluate", folder / "run", "--truth", truth});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("rows 15 to 18 of 250"));
  EXPECT_THAT(run.out, HasSubstr("3 of 3 steps: true speed above 2 m/s, times from"));
  EXPECT_THAT(run.out, ContainsRegex("[^_]scale_bias +\\+0\\.000 %"));
  EXPECT_THAT(run.out, ContainsRegex("online_scale_bias +\\+10\\.000 %"));
  EXPECT_THAT(run.out, ContainsRegex("raw_scale_bias +-3\\.000 % +2 steps"));
  EXPECT_THAT(run.out, ContainsRegex("coverage +66\\.67 % +3 steps"));
  EXPECT_THAT(run.out, ContainsRegex("first_accepted_frame +16 "));
}

TEST_F(EvaluateCommand, RefusesWrongUseWithStatusTwo) {
  EXPECT_THAT(refused({estimate}), HasSubstr("--truth"));
  EXPECT_THAT(refused({"--truth", truth}), HasSubstr("ESTIMATE"));
  EXPECT_THAT(refused({estimate, "--truth", truth, "--nonsense"}), HasSubstr("--nonsense"));
  EXPECT_THAT(refused({estimate, "--truth", truth, "--lengths", "abc"}), HasSubstr("abc"));
  EXPECT_THAT(refused({estimate, "--truth", truth, "--lengths", "100,-5"}), HasSubstr("-5"));
  EXPECT_THAT(refused({estimate, "--truth", truth, "--skip", "-3"}), HasSubstr("-3"));
  EXPECT_THAT(refused({estimate, "--truth", truth, "--json", folder / "nowhere/f.json"}), HasSubstr("nowhere"));
}

TEST_F(EvaluateCommand, RefusesBadInputWithStatusTwoAndBothNumbers) {
  EXPECT_THAT(refused({estimate, "--truth", truth, "--truth-offset", "21"}),
              AllOf(HasSubstr("rows 21 to 250"), HasSubstr("250 rows")));
  EXPECT_THAT(refused({estimate, "--truth", folder.file("short.txt", straight_rows(100, 1.0))}),
              AllOf(HasSubstr("rows 0 to 229"), HasSubstr("100 rows")));
  EXPECT_THAT(refused({estimate, "--truth", folder.file("still.txt", straight_rows(230, 0.0))}),
              HasSubstr("stands still"));
  EXPECT_THAT(refused({folder.file("nan.kitti", "1 0 0 0 0 1 0 0 0 0 1 nan\n"), "--truth", truth}),
              HasSubstr("nan.kitti:1"));
  EXPECT_THAT(refused({folder / "absent", "--truth", truth}), HasSubstr("absent"));
  EXPECT_THAT(refused({folder.path(), "--truth", truth}), HasSubstr("trajectory.kitti"));
}

TEST_F(EvaluateCommand, HelpIsNoError) {
  const ProgramRun run = run_program({"evaluate", "--help"});
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.out, HasSubstr("--truth-offset"));
  EXPECT_EQ(run_program({"--version"}).status, 0);
  EXPECT_EQ(run_program({}).status, 2);
  EXPECT_EQ(run_program({"nonsense"}).status, 2);
}

TEST_F(EvaluateCommand, AFullDiskUnderTheResultsIsStatusOne) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  EXPECT_EQ(run_program({"evaluate", estimate, "--truth", truth, "--json", "/dev/full/x"}).status, 2);
  const std::string command = std::string(std::getenv("GROUNDSCALE_PROGRAM")) + " evaluate " + estimate + " --truth " +
                              truth + " > /dev/full 2> /dev/null";
  const int raw = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(raw));
  EXPECT_EQ(WEXITSTATUS(raw), 1);
}

}  // namespace
}  // namespace groundscale
