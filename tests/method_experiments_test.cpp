// groundscale experiment synthetic, contamination, timing: what they write, and that it is the same again.

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/experiments/plot.hpp"
#include "program.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::TempFolder;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

using Words = std::vector<std::string>;

/// 1 where only the pictures are missing.
int expected_status() { return gnuplot_is_there() ? 0 : 1; }

std::string text(const std::string& path) {
  const auto read = read_text(path);
  return read ? *read : read.error().message;
}

TEST(SyntheticExperiment, WritesTableFindingsAndFiguresAndTheSameAgain) {
  const TempFolder folder;
  const std::string output = folder / "out";
  const Words arguments = {
      "experiment",   "synthetic", "--output", output, "--preset",  "small",  "--frames", "2",
      "--trials",     "5",         "--speeds", "20",   "--methods", "sparse", "--set",    "ground.plane.min_inliers=20",
      "--noise-step", "1"};
  const ProgramRun first = run_program(arguments);
  ASSERT_EQ(first.status, expected_status()) << first.err;
  EXPECT_THAT(first.out, HasSubstr("20 km/h, estimated R, t\n\n| noise px | sparse % |"));
  EXPECT_THAT(first.out, HasSubstr("- not measured: joint is worse than sparse (20 km/h, true R, t)"));

  const std::string table = text(output + "/synthetic.csv");
  EXPECT_THAT(table, StartsWith("speed_kmh,motion,noise_px,method,pitch_error_deg,trials,refused,median,q25,q75\n"
                                "20,true,0,sparse,0,5,0,"));
  const std::string report = text(output + "/synthetic.md");
  EXPECT_THAT(report, HasSubstr("groundscale experiment synthetic --output "));
  EXPECT_THAT(report, HasSubstr("min_inliers 20"));
  for (const char* name : {"scale-error-20-kmh-true-motion", "scale-error-20-kmh-estimated-motion"}) {
    EXPECT_TRUE(fs::exists(output + "/figures/" + name + ".gp")) << name;
    EXPECT_EQ(fs::exists(output + "/figures/" + name + ".svg"), gnuplot_is_there()) << name;
  }

  const ProgramRun again = run_program(arguments);
  EXPECT_EQ(again.status, first.status) << again.err;
  EXPECT_THAT(again.err, Not(HasSubstr("rendering")));
  EXPECT_EQ(text(output + "/synthetic.csv"), table);
  EXPECT_EQ(text(output + "/synthetic.md"), report);
}

}  // namespace
}  // namespace groundscale
