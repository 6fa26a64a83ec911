#include "groundscale/report/run_report.hpp"

#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/core/check.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/report/run_parts_internal.hpp"
#include "groundscale/report/test_markup_internal.hpp"
#include "groundscale/report/test_run_internal.hpp"

namespace groundscale {
namespace {

using internal::occurrences;
using internal::TempFolder;
using internal::what_is_wrong;
using internal::WrittenRun;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

class Runs : public testing::Test {
 protected:
  RunFolder read(const WrittenRun& run, const std::string& name = "run", const std::string& truth = "") const {
    run.write(folder_, name);
    auto read = read_run_folder(folder_ / name, truth);
    GS_CHECK(read.has_value(), read ? "" : read.error().message);
    return std::move(*read);
  }
  std::string error_of(const std::string& name, const std::string& truth = "") const {
    const auto read = read_run_folder(folder_ / name, truth);
    if (read) return "no error";
    EXPECT_EQ(read.error().code, ErrorCode::kBadInput);
    return read.error().message;
  }
  TempFolder folder_;
};

TEST_F(Runs, AreReadAsTheyWereWritten) {
  const RunFolder run = read({.first_frame = 7, .config = "ground:\n  method: sparse\nodometry:\n  seed: 0\n"});
  ASSERT_EQ(run.frames.size(), 40U);
  EXPECT_EQ(run.frames[1].state, "moving");
  EXPECT_EQ(run.frames[1].roll_deg, -0.1);
  EXPECT_EQ(run.frames[1].map_scale, 2.5);
  EXPECT_EQ(run.trajectory.size(), 40);
  EXPECT_DOUBLE_EQ(run.distances_m().back(), 39.0);
  EXPECT_EQ(run.drive, "drive, from frame 7 on");
  EXPECT_TRUE(run.samples.empty());
  EXPECT_FALSE(run.compared);
}

TEST_F(Runs, ConfigurationIsSetBesideItsDefaults) {
  const RunFolder run = read({.config = "odometry:\n  mode: pairwise\n"});
  std::vector<std::string> differing;
  for (const RunFolder::Setting& setting : run.settings) {
    if (setting.differs()) differing.push_back(setting.name + "=" + setting.value);
  }
  EXPECT_THAT(differing, ElementsAre("odometry.mode=pairwise", "run.source=\"drive\""));
  const RunFolder other = read({.config = "unknown:\n  key: <1>\n"});
  EXPECT_TRUE(other.settings.empty());
  EXPECT_THAT(run_report_html(other), HasSubstr("key: &lt;1&gt;"));
}

TEST_F(Runs, AreComparedWithTheTruthThatTheyWereTold) {
  const std::string truth = folder_.file("truth.txt", WrittenRun{.step_m = 1.02}.rows(1.02));
  const RunFolder run = read({.truth = "\"" + truth + "\""});
  ASSERT_TRUE(run.compared);
  EXPECT_NEAR(run.compared->evaluation.scale.all.value().bias, 1.0 / 1.02 - 1.0, 1e-9);
  const std::string html = run_report_html(run);
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, HasSubstr("class=\"curve truth\""));
  EXPECT_THAT(html, HasSubstr("<th>scale_bias</th><td>-1.961</td>"));
  EXPECT_THAT(html, HasSubstr("steps are -1.96 % off in the median"));
}

TEST_F(Runs, ATruthThatIsGoneIsSaidAndOneThatIsNamedRefused) {
  const RunFolder run = read({.truth = "\"/nonexistent/poses.txt\""});
  EXPECT_FALSE(run.compared);
  EXPECT_THAT(run_report_html(run), HasSubstr("can&#39;t be compared with the truth: "));
  EXPECT_THAT(error_of("run", folder_.file("short.txt", WrittenRun{.frames = 5}.rows(1.0))), HasSubstr("--truth: "));
}

TEST_F(Runs, FoldersOfNoRunAndOfOneThatDidNotEndAreRefused) {
  EXPECT_THAT(error_of("none"), EndsWith("none: no such folder"));
  folder_.file("file", "x");
  EXPECT_THAT(error_of("file"), EndsWith("file: is no folder; that of a run is needed"));
  folder_.file("other/notes.txt", "x");
  EXPECT_THAT(error_of("other"), EndsWith("isn't the folder of a run (there is no summary.json)"));
  folder_.file("begun/online.kitti", "");
  EXPECT_THAT(error_of("begun"), EndsWith("the run in it didn't end (there is no summary.json)"));
  WrittenRun{}.write(folder_, "mixed");
  folder_.file("mixed/trajectory.kitti", WrittenRun{.frames = 12}.rows(1.0));
  EXPECT_THAT(error_of("mixed"), EndsWith("frames.csv has 40 rows, trajectory.kitti has 12: they are not of one run"));
}

TEST_F(Runs, ReportIsWellFormedAndNeedsNothingElse) {
  WrittenRun{.refused_from = 30}.write(folder_, "run");
  ASSERT_TRUE(
      write_samples(folder_ / "run/samples", {{12, "deviation", 2.5, "picture"}, {35, "refused", 0.0, "other"}}));
  const auto run = read_run_folder(folder_ / "run");
  ASSERT_TRUE(run);
  const std::string html = run_report_html(*run);
  EXPECT_EQ(what_is_wrong(html), "");
  for (const char* foreign : {"<script", "://", "href=", "@import", "url(", "nan", "<b>\"", "low <b>"}) {
    EXPECT_THAT(html, Not(HasSubstr(foreign)));
  }
  EXPECT_EQ(occurrences(html, "src=\"data:image/jpeg;base64,"), 2);
  EXPECT_THAT(html,
              HasSubstr("Frame 12, among the worst: measurement 2.5 sd off the filtered step: moving, step 1.000 m"));
  EXPECT_THAT(html, HasSubstr("<th>speed ... m/s, too low &lt;b&gt;</th><td>10</td><td>25.0 %</td><td>30</td>"));
  for (const char* part : {"Trajectory from above", "Scale of the map", "Pitch and roll", "Coverage", "Corrections",
                           "Time", "Sample frames", "Configuration", "12.00 ms"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  EXPECT_EQ(run_report_html(*run), html);
}

TEST_F(Runs, ADriveWithoutScaleHasAReportToo) {
  WrittenRun run{.frames = 3, .refused_from = 0};
  run.write(folder_, "run");
  std::string csv = read_text(folder_ / "run/frames.csv").value();
  folder_.file("run/frames.csv", csv.substr(0, csv.find('\n') + 1) +
                                     "0,0,lost,,,,,,,,0,0,0,first frame,,,\n1,0.1,lost,,,,,,,,0,0,0,dark,,,\n"
                                     "2,0.2,lost,,,,,,,,0,0,0,dark,,,\n");
  folder_.file("run/trajectory.kitti", run.rows(0.0));
  const auto read = read_run_folder(folder_ / "run");
  ASSERT_TRUE(read) << read.error().message;
  const std::string html = run_report_html(*read);
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, Not(HasSubstr("nan")));
  EXPECT_THAT(html, HasSubstr("Not to be relied upon. The road was never measured"));
}

TEST_F(Runs, ManyCorrectionsAreCutToTheLargest) {
  std::string corrections = "[";
  for (int k = 1; k < 39; ++k) {
    corrections += fmt::format("{}{{\"frame\": {}, \"lambda\": {}, \"drift_before\": 1.1, \"drift_after\": null}}",
                               k > 1 ? ", " : "", k, k == 20 ? 0.5 : 1.0 + 0.001 * k);
  }
  const std::string html = run_report_html(read({.corrections = corrections + "]"}));
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, HasSubstr("The 20 largest of 38 corrections:"));
  EXPECT_THAT(html, HasSubstr("<th>20</th><td>0.5000</td><td>1.1000</td><td>\u2013</td>"));
  EXPECT_THAT(html, Not(HasSubstr("<th>18</th>")));
  EXPECT_THAT(html, HasSubstr("The map was scaled 38 times, by up to 50.0 %."));
}

Grade grade_of(const RunFolder& run) { return verdict_of(run).grade; }

TEST_F(Runs, VerdictFollowsItsRules) {
  EXPECT_EQ(grade_of(read({})), Grade::kNote);
  EXPECT_THAT(verdict_of(read({})).words, "Nothing speaks against this run.");
  EXPECT_EQ(grade_of(read({.refused_from = 15})), Grade::kReservation);  // 14 of 40
  EXPECT_THAT(verdict_of(read({.refused_from = 15})).words, HasSubstr("14 of 40 moving frames (35 %)"));
  EXPECT_EQ(grade_of(read({.refused_from = 0})), Grade::kBad);
  EXPECT_EQ(grade_of(read({.lost = 1})), Grade::kReservation);
  EXPECT_EQ(grade_of(read({.lost = 5})), Grade::kBad);
  EXPECT_EQ(grade_of(read({.warnings = "[\"one\"]"})), Grade::kReservation);
  const std::string corrected = R"([{"frame": 5, "lambda": 1.2, "drift_before": 1.2, "drift_after": null}])";
  EXPECT_EQ(grade_of(read({.corrections = corrected})), Grade::kReservation);
}

TEST_F(Runs, VerdictHoldsErrorsAgainstTheTruth) {
  const auto grade = [this](double true_step_m) {
    const std::string truth = folder_.file("truth.txt", WrittenRun{}.rows(true_step_m));
    return grade_of(read({}, "run", truth));
  };
  EXPECT_EQ(grade(1.001), Grade::kNote);
  EXPECT_EQ(grade(1.05), Grade::kReservation);
  EXPECT_EQ(grade(1.2), Grade::kBad);
}

TEST_F(Runs, LongestGapIsThatBetweenAcceptedMeasurements) {
  EXPECT_DOUBLE_EQ(longest_gap_m(read({})), 1.0);
  EXPECT_DOUBLE_EQ(longest_gap_m(read({.refused_from = 15})), 25.0);
  EXPECT_DOUBLE_EQ(longest_gap_m(read({.refused_from = 0})), 0.0);
  EXPECT_NEAR(median_relative_sd(read({.step_m = 2.0})).value(), 0.015, 1e-9);
}

TEST_F(Runs, OfOneDriveAreLaidOverEachOther) {
  const std::string html =
      comparison_html({read({}, "a"), read({.step_m = 1.1, .config = "odometry:\n  mode: pairwise\n"}, "b")});
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, HasSubstr("<h1>2 runs beside each other</h1>"));
  EXPECT_THAT(html, HasSubstr("<tr><th>length, m</th><td>39.00</td><td>42.90</td></tr>"));
  EXPECT_THAT(html, HasSubstr("<tr><th>odometry.mode</th><td>keyframe</td><td>pairwise</td></tr>"));
  EXPECT_THAT(html, Not(HasSubstr("different drives")));
  EXPECT_EQ(occurrences(html, "<h2>Curves"), 1);
  EXPECT_THAT(html, HasSubstr("Pieces of 20 m of the final trajectories over those of a"));
}

TEST_F(Runs, OfDifferentDrivesAreNotLaidOverEachOther) {
  const std::string html =
      comparison_html({read({}, "a"), read({.source = "other <drive>"}, "b"), read({.frames = 20}, "c")});
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, HasSubstr("These runs are of 2 different drives:"));
  EXPECT_THAT(html, HasSubstr("<li>drive: a, c</li>"));
  EXPECT_THAT(html, HasSubstr("<li>other &lt;drive&gt;: b</li>"));
  EXPECT_THAT(html, HasSubstr("The runs of drive have different numbers of frames:"));
  EXPECT_EQ(occurrences(html, "<h2>Curves"), 2);
}

TEST_F(Runs, NamesAreAsShortAsTheyCanBe) {
  const auto runs = std::vector{read({}, "a/run"), read({}, "b/run"), read({}, "b/other")};
  EXPECT_THAT(internal::short_names(runs), ElementsAre("a/run", "b/run", "b/other"));
  EXPECT_THAT(internal::short_names({runs[0], runs[2]}), ElementsAre("run", "other"));
}

}  // namespace
}  // namespace groundscale
