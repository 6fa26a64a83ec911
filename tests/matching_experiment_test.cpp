// groundscale experiment matching: each front end on a short simulated drive, against the true transfer.

#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/experiments/plot.hpp"
#include "program.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::HasSubstr;
using testing::Not;

ProgramRun matching(const std::string& output, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = {"experiment", "matching", "--output", output,        "--preset",
                                        "small",      "--frames", "6",        "--sequences", "straight"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(arguments);
}

using Row = std::map<std::string, std::string>;

/// Rows of matching.csv; fields in quotes hold a comma.
std::vector<Row> rows_of(const std::string& path) {
  std::istringstream lines(*read_text(path));
  std::vector<std::string> names;
  std::vector<Row> rows;
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') {
        quoted = !quoted;
      } else if (c == ',' && !quoted) {
        cells.emplace_back();
      } else {
        cells.back() += c;
      }
    }
    if (names.empty()) {
      names = cells;
      continue;
    }
    Row row;
    for (std::size_t k = 0; k < names.size(); ++k) row[names[k]] = cells.at(k);
    rows.push_back(row);
  }
  return rows;
}

TEST(MatchingExperiment, ComparesBothFrontEndsWithTheTruthAndDoesNothingTwice) {
  const TempFolder folder;
  const std::string output = folder / "out";
  const ProgramRun first = matching(output);
  ASSERT_EQ(first.status, gnuplot_is_there() ? 0 : 1) << first.err;
  std::map<std::string, Row> whole;
  for (const Row& row : rows_of(output + "/matching.csv")) {
    if (row.at("pairs_of") == "straight") whole[row.at("front_end")] = row;
  }
  ASSERT_EQ(whole.size(), 4U);
  for (const auto& [name, row] : whole) {
    EXPECT_EQ(row.at("pairs"), "4") << name;  // of six frames, the first and the last left out
    EXPECT_GT(std::stod(row.at("matches")), 20.0) << name;
    EXPECT_LE(std::stod(row.at("within_half_px")), std::stod(row.at("within_2_px"))) << name;
  }
  // Of the clean images of a simulated road nearly all matches through the warp are right.
  for (const char* name : {"klt, warped", "stereoscan, warped"}) {
    EXPECT_GT(std::stod(whole.at(name).at("within_1_px")), 80.0) << name;
    EXPECT_LT(std::stod(whole.at(name).at("median_px")), 0.3) << name;
  }
  const std::string report = *read_text(output + "/matching.md");
  EXPECT_THAT(report, HasSubstr("groundscale experiment matching --output "));
  EXPECT_THAT(report, HasSubstr("--road-masks --depth"));
  EXPECT_THAT(report, HasSubstr("## Figures"));
  EXPECT_TRUE(std::filesystem::exists(output + "/figures/errors.csv"));

  const ProgramRun again = matching(output);
  EXPECT_EQ(again.status, first.status);
  EXPECT_THAT(again.err, Not(HasSubstr("matching\n")));
  EXPECT_EQ(*read_text(output + "/matching.md"), report);
}

TEST(MatchingExperiment, RefusesAnUnknownKeyBeforeAnythingIsWritten) {
  const TempFolder folder;
  const ProgramRun run = matching(folder / "out", {"--set", "tracking.front_ent=klt"});
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.err, HasSubstr("front_end"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(MatchingExperiment, SaysWhyThereAreNoPairs) {
  const TempFolder folder;
  const ProgramRun run = run_program(
      {"experiment", "matching", "--output", folder / "out", "--preset", "small", "--sequences", "straight:2"});
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("drive straight: no pair can be matched: it takes three frames"));
}

}  // namespace
}  // namespace groundscale
