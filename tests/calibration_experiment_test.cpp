// groundscale experiment calibration: what it writes, and that it goes on where it was.

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::HasSubstr;
using testing::Not;

/// A straight too short to tell anything: rendered and seen within a second.
ProgramRun straight(const std::string& output, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = {"experiment", "calibration", "--output", output,
                                        "--parts",    "straight",    "--frames", "7"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(arguments);
}

TEST(CalibrationExperiment, WritesTableAimsAndDrivesAndGoesOnWhereItWas) {
  const TempFolder folder;
  const std::string output = folder / "out";
  const ProgramRun first = straight(output);
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("met: nothing changes: 0 of 2 calibrations changed something"));
  EXPECT_THAT(first.out, HasSubstr("degrees of turning are too little, 30 are needed"));
  const std::string report = read_text(output + "/calibration.md").value();
  EXPECT_THAT(report, HasSubstr("    groundscale experiment calibration --output "));
  EXPECT_THAT(report, HasSubstr("    groundscale simulate --output "));
  EXPECT_THAT(read_text(output + "/report.html").value(),
              HasSubstr("<pre>groundscale experiment calibration --output "));
  EXPECT_THAT(report, Not(HasSubstr("not done yet")));
  const std::string table = read_text(output + "/straight.csv").value();
  EXPECT_THAT(table, HasSubstr("\nstraight-small,\"k1 -0.02, cy +5 px\",-0.02,-0.02,,,"));
  EXPECT_FALSE(std::filesystem::exists(output + "/seeds.csv")) << "only what was asked for";

  const ProgramRun again = straight(output);
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(again.err, "") << "nothing is rendered or calibrated again";
  EXPECT_EQ(again.out, first.out);
  EXPECT_EQ(read_text(output + "/calibration.md").value(), report);

  const ProgramRun other = straight(output, {"--set", "seed=3"});
  EXPECT_EQ(other.status, 0) << other.err;
  EXPECT_THAT(other.err, Not(HasSubstr("rendering")));
  EXPECT_THAT(other.err, HasSubstr("straight-small: calibrating from k1 -0.02, cy +5 px"));
}

TEST(CalibrationExperiment, ReportsWhatFailedAndDoesTheRest) {
  const TempFolder folder;
  const std::string output = folder / "out";
  ASSERT_EQ(straight(output).status, 0);
  const std::string kept = output + "/calibrations/straight/straight-small/k1-0.02_cy+5px/calibration.json";
  ASSERT_TRUE(write_text(kept, "{"));
  const ProgramRun again = straight(output);
  EXPECT_EQ(again.status, 1);
  EXPECT_THAT(again.err, HasSubstr("straight, straight-small from k1 -0.02, cy +5 px: "));
  EXPECT_THAT(again.err, HasSubstr("a result in it can't be read"));
  EXPECT_THAT(again.out, HasSubstr("met: nothing changes: 0 of 1 calibrations"));
}

TEST(CalibrationExperiment, RefusesBeforeItWrites) {
  const TempFolder folder;
  const ProgramRun refused = straight(folder / "out", {"--parts", "seedz"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("--parts: 'seedz' is no part, known: seeds, drives, straight,"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  EXPECT_EQ(straight(folder / "out", {"--set", "seeds=3"}).status, 2);
}

}  // namespace
}  // namespace groundscale
