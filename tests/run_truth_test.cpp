// `run --truth`: the table of `evaluate` at the end of a run.

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/temp_folder_internal.hpp"
#include "program.hpp"
#include "synthetic_drive.hpp"

namespace groundscale {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

TEST(RunTruth, PrintsTheTableOfEvaluateAfterTheSummary) {
  constexpr int kFrames = 8;
  const internal::TempFolder folder;
  const SyntheticDrive drive;
  drive.write_kitti(folder / "drive", kFrames);
  const std::string truth = folder.file("truth.txt", drive.truth(kFrames));
  const std::string output = folder / "output";
  const ProgramRun run = run_program({"run", folder / "drive", "--output", output, "--start", "2", "--truth", truth});
  ASSERT_EQ(run.status, 0) << run.err;
  const ProgramRun evaluation = run_program({"evaluate", output, "--truth", truth});
  ASSERT_EQ(evaluation.status, 0) << evaluation.err;
  EXPECT_THAT(evaluation.out, HasSubstr("rows 2 to 7 of 8"));
  EXPECT_THAT(run.out, HasSubstr("camera height"));
  EXPECT_THAT(run.out, EndsWith("\n\n" + evaluation.out));
}

TEST(RunTruth, ARunThatCanNotBeComparedIsWholeAndEndsWithOne) {
  constexpr int kFrames = 4;
  const internal::TempFolder folder;
  SyntheticDrive drive;
  drive.write_kitti(folder / "drive", kFrames);
  drive.step_m = 0.0;
  const std::string truth = folder.file("still.txt", drive.truth(kFrames));
  const ProgramRun run = run_program({"run", folder / "drive", "--output", folder / "output", "--truth", truth});
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("is whole, but can't be evaluated: "));
  EXPECT_TRUE(read_text(folder / "output/summary.json"));
}

}  // namespace
}  // namespace groundscale
