#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/experiments/contest_report_internal.hpp"

namespace groundscale::internal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// Straight ahead, 1 m a row, times a factor.
Trajectory ahead(int rows, double factor = 1.0) {
  Trajectory trajectory;
  for (int k = 0; k < rows; ++k) {
    trajectory.world_from_cam.push_back({Eigen::Matrix3d::Identity(), {0.0, 0.0, factor * k}});
  }
  return trajectory;
}

Contender contender(const std::string& label, double factor) {
  const Trajectory truth = ahead(121);
  Contender made{.label = label,
                 .figures = {{"t_rel", 100.0 * (factor - 1.0)}},
                 .measures = measure_path(ahead(121, factor), truth, RigidTransform{}).value(),
                 .run = {},
                 .remark = ""};
  return made;
}

Contender own(const std::string& label, double factor) {
  Contender made = contender(label, factor);
  made.run = MeasuredRun{};
  made.run->length_m = 120.0;
  made.run->corrections = 3;
  made.run->commands = {"groundscale run somewhere"};
  return made;
}

ContestedDrive drive(const std::string& name, std::vector<Contender> contenders) {
  return {.name = name,
          .drive = {.name = name, .folder = name, .key = "", .command = "groundscale simulate " + name},
          .truth = ahead(121),
          .contenders = std::move(contenders),
          .problems = {}};
}

TEST(ContestTable, HasARowATrajectoryAndTheirMeansOverTheirDrives) {
  const Table table = contest_table({drive("06", {own("none", 1.04), own("filtered", 1.01)}),
                                     drive("09", {own("none", 1.02), contender("ORB (aligned by sim3)", 1.05)})});
  const std::string shown = table.markdown({"sequence", "mode", "length_m", "t_rel", "corrections"});
  EXPECT_EQ(shown,
            "| sequence | mode | length m | t_rel % | corrections |\n|---|---|---:|---:|---:|\n"
            "| 06 | none | 120 | 4.000 | 3 |\n"
            "| 06 | filtered | 120 | 1.000 | 3 |\n"
            "| 09 | none | 120 | 2.000 | 3 |\n"
            "| 09 | ORB (aligned by sim3) | 120 | 5.000 |  |\n"
            "| mean of 2 | none |  | 3.000 | 3 |\n"
            "| mean of 1 | filtered |  | 1.000 | 3 |\n"
            "| mean of 1 | ORB (aligned by sim3) |  | 5.000 |  |\n");
}

TEST(ContestTable, OneDriveHasNoMeans) {
  EXPECT_EQ(contest_table({drive("06", {own("none", 1.04)})}).rows().size(), 1U);
}

TEST(ContestPlots, AreTrajectoryErrorsAndScaleOfEachDrive) {
  const auto plots = contest_plots({drive("06", {own("none", 1.04), own("filtered", 1.01)})});
  std::vector<std::string> names;
  for (const Plot& plot : plots) names.push_back(plot.name);
  EXPECT_THAT(names, ElementsAre("trajectory-06", "t_rel-06", "r_rel-06", "scale-06"));
  EXPECT_THAT(plots[0].columns,
              ElementsAre("truth_x_m", "truth_z_m", "none_x_m", "none_z_m", "filtered_x_m", "filtered_z_m"));
  const Plot& scale = plots[3];
  ASSERT_EQ(scale.rows.size(), 6U) << "120 m in pieces of 20 m";
  EXPECT_NEAR(scale.rows[0][0].value(), 10.0, 1e-9);
  EXPECT_NEAR(scale.rows[5][0].value(), 110.0, 1e-9);
  EXPECT_NEAR(scale.rows[5][1].value(), 1.04, 1e-9);
  EXPECT_NEAR(scale.rows[5][2].value(), 1.01, 1e-9);
}

TEST(ContestReport, SaysWhatIsMissingWhatWasComparedAndHowItWasMade) {
  ContestResult result;
  result.drives = {drive("06", {own("none", 1.04)})};
  result.drives.front().contenders.front().remark = "the first 121 of the 500 rows in 06.txt";
  result.problems = {"drive 07: not done yet"};
  result.remarks = {"ORB (aligned by sim3): no trajectory of 06"};
  result.aims = {{.what = "t_rel", .met = false, .measured = "4 %"}};
  const std::string report =
      contest_report({.name = "vo-kitti", .summary = "words", .aims = nullptr}, result, {}, ExperimentRequest{}, false);
  for (const char* part :
       {"**Not complete:**\n\n- drive 07: not done yet", "- not met: t_rel: 4 %",
        "- none on 06: the first 121 of the 500 rows in 06.txt", "- ORB (aligned by sim3): no trajectory of 06",
        "groundscale simulate 06", "groundscale run somewhere"}) {
    EXPECT_THAT(report, HasSubstr(part));
  }
  EXPECT_THAT(report, Not(HasSubstr("## Seeds")));
}

TEST(ContestReport, HasTheSpreadOverSeeds) {
  ContestResult result;
  result.drives = {drive("06", {own("filtered", 1.01)})};
  result.seeds = {.drive = "06", .mode = "filtered", .runs = {own("0", 1.01), own("1", 1.03)}, .same_bytes = true};
  const std::string report =
      contest_report({.name = "vo-kitti", .summary = "words", .aims = nullptr}, result, {}, ExperimentRequest{}, false);
  EXPECT_THAT(report, HasSubstr("## Seeds: `filtered` on 06"));
  EXPECT_THAT(report, HasSubstr("- t_rel: 1.000 to 3.000 %, sd 1.414 %"));
  EXPECT_THAT(report, HasSubstr("the same bytes"));
  result.seeds.same_bytes = false;
  EXPECT_THAT(
      contest_report({.name = "vo-kitti", .summary = "words", .aims = nullptr}, result, {}, ExperimentRequest{}, false),
      HasSubstr("**other bytes**"));
}

TEST(SegmentLengths, BeginAt50mOnShortPaths) {
  EXPECT_EQ(segment_lengths_m(999.0).front(), 50.0);
  EXPECT_EQ(segment_lengths_m(1000.0).front(), 100.0);
}

}  // namespace
}  // namespace groundscale::internal
