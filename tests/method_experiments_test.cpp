// groundscale experiment synthetic, contamination, timing: what they write, and that it is the same again.

#include <filesystem>
#include <sstream>
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

TEST(SyntheticExperiment, WritesTablesWithoutFiguresWhereNothingCouldBeMeasured) {
  const TempFolder folder;
  const std::string output = folder / "out";
  // No ground lies as low as the points are far away.
  const ProgramRun run = run_program({"experiment",     "synthetic",
                                      "--output",       output,
                                      "--preset",       "small",
                                      "--frames",       "2",
                                      "--trials",       "2",
                                      "--speeds",       "20",
                                      "--methods",      "triangulation",
                                      "--pitch-errors", "0",
                                      "--set",          "ground.plane.min_inliers=20",
                                      "--set",          "ground.plane.triangulation.min_height=1",
                                      "--noise-step",   "0.6"});
  ASSERT_EQ(run.status, expected_status()) << run.err;
  // 0, 0.6, 1.2 and 1.8 px, and no more than the 2 px that are asked for.
  EXPECT_THAT(text(output + "/synthetic.csv"), HasSubstr("20,true,1.8,triangulation,0,2,2,,,\n"));
  EXPECT_THAT(text(output + "/synthetic.csv"), Not(HasSubstr(",2.4,")));
  EXPECT_THAT(text(output + "/synthetic.md"), Not(HasSubstr("## Figures")));
}

/// Lines of a CSV file, in cells.
std::vector<Words> rows_of(const std::string& csv) {
  std::vector<Words> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream cells(line + ",");
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

TEST(ContaminationExperiment, ReachesItsSharesAndDoesNothingAgain) {
  const TempFolder folder;
  const std::string output = folder / "out";
  const Words arguments = {"experiment",  "contamination", "--output",  output,   "--preset", "small",
                           "--sequences", "straight:5",    "--methods", "sparse", "--shares", "0,20,50"};
  const ProgramRun first = run_program(arguments);
  ASSERT_EQ(first.status, expected_status()) << first.err;
  EXPECT_THAT(first.out, HasSubstr("whole region, median of |error| in %:\n\n| share % | pairs | sparse |"));
  const std::string pairs = text(output + "/pairs.csv");
  const std::vector<Words> rows = rows_of(pairs);
  ASSERT_GT(rows.size(), 9U);
  EXPECT_EQ(rows[0], (Words{"drive", "frame", "region", "share", "region_share", "method", "error"}));
  int whole = 0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    if (rows[k][2] == "mask") {
      EXPECT_EQ(rows[k][4], "0");
    }
    if (rows[k][2] != "whole") continue;
    ++whole;
    EXPECT_NEAR(std::stod(rows[k][4]), std::stod(rows[k][3]), 2.5);  // %, the stated tolerance
  }
  EXPECT_GE(whole, 9);  // of 4 pairs and 3 shares
  EXPECT_THAT(text(output + "/contamination.md"), HasSubstr("--road-masks"));

  const ProgramRun again = run_program(arguments);
  EXPECT_EQ(again.status, first.status) << again.err;
  EXPECT_THAT(again.err, Not(HasSubstr("measuring")));
  EXPECT_EQ(text(output + "/pairs.csv"), pairs);
}

TEST(TimingExperiment, TimesWhatComesBeforeAndTheMethods) {
  const TempFolder folder;
  const std::string output = folder / "out";
  const Words arguments = {"experiment", "timing",      "--output",   output,      "--preset",
                           "small",      "--sequences", "straight:4", "--methods", "sparse"};
  const ProgramRun first = run_program(arguments);
  ASSERT_EQ(first.status, expected_status()) << first.err;
  EXPECT_THAT(first.out, HasSubstr("not measured: dense is slowest by far"));
  const std::string table = text(output + "/timing.csv");
  const std::vector<Words> rows = rows_of(table);
  Words parts;
  for (const Words& row : rows) parts.push_back(row[0]);
  EXPECT_THAT(parts, testing::ElementsAre("part", "tracking", "motion", "road matching", "sparse"));
  for (std::size_t k = 1; k < rows.size(); ++k) {
    EXPECT_EQ(rows[k][2], "3") << rows[k][0];
    EXPECT_GT(std::stod(rows[k][4]), 0.0) << rows[k][0];
    EXPECT_GE(std::stod(rows[k][5]), std::stod(rows[k][4])) << rows[k][0];
  }
  EXPECT_EQ(fs::exists(output + "/figures/time.svg"), gnuplot_is_there());

  const ProgramRun again = run_program(arguments);
  EXPECT_THAT(again.err, Not(HasSubstr("timing")));
  EXPECT_EQ(text(output + "/timing.csv"), table);
}

TEST(ScaleKittiExperiment, HasARowAMethodAndSettingAndIsResumed) {
  const TempFolder folder;
  const std::string output = folder / "out";
  const Words arguments = {"experiment", "scale-kitti", "--output",   output,      "--preset",
                           "small",      "--sequences", "straight:6", "--methods", "sparse,triangulation"};
  const ProgramRun first = run_program(arguments);
  ASSERT_EQ(first.status, expected_status()) << first.err;
  EXPECT_THAT(first.out, HasSubstr("fixed region, the paper's filter:\n\n| method | straight (simulated) |"));
  const std::vector<Words> rows = rows_of(text(output + "/scale-kitti.csv"));
  // Two regions, three filters, two methods.
  ASSERT_EQ(rows.size(), 1U + 2 * 3 * 2);
  EXPECT_EQ(rows[0][0], "sequence");
  for (std::size_t k = 1; k < rows.size(); ++k) {
    EXPECT_EQ(rows[k][1], "simulated");
    if (rows[k][4] != "sparse") continue;
    // Unfiltered and filtered errors of a level street are a few per cent at most.
    EXPECT_LT(std::stod(rows[k][6]), 10.0) << rows[k][2] << ' ' << rows[k][3];
  }
  EXPECT_EQ(fs::exists(output + "/figures/scale-path-none.svg"), gnuplot_is_there());
  // Times differ from run to run: what is done isn't done again.
  const std::string table = text(output + "/scale-kitti.csv");
  const ProgramRun again = run_program(arguments);
  EXPECT_EQ(again.status, first.status) << again.err;
  EXPECT_EQ(text(output + "/scale-kitti.csv"), table);
}

TEST(ScaleKittiExperiment, RefusesARootWithoutSequencesAndUnknownMethods) {
  const TempFolder folder;
  const auto refused = [&folder](const Words& more) {
    Words arguments = {"experiment", "scale-kitti", "--output", folder / "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramRun run = run_program(arguments);
    EXPECT_EQ(run.status, 2);
    EXPECT_FALSE(fs::exists(folder / "out"));
    return run.err;
  };
  fs::create_directories(folder / "root");
  EXPECT_THAT(refused({"--kitti", folder / "root"}), HasSubstr("holds no poses/NN.txt"));
  EXPECT_THAT(refused({"--methods", "spares"}), HasSubstr("\"spares\" is no method, known: sparse"));
}

}  // namespace
}  // namespace groundscale
