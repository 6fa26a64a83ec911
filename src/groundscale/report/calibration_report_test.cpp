#include "groundscale/report/calibration_report.hpp"

#include <cmath>
#include <limits>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/core/rng.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/report/calibration_figures_internal.hpp"
#include "groundscale/report/markup_internal.hpp"
#include "groundscale/report/test_markup_internal.hpp"

namespace groundscale {
namespace {

using internal::escape_html;
using internal::occurrences;
using internal::what_is_wrong;
using testing::HasSubstr;
using testing::Not;

/// Residuals that point outwards, as far as `corner_px` in the corners of an image of 640 x 480 px.
ResidualMap outward_map(double corner_px) {
  ResidualMap map{.width = 640, .height = 480, .columns = 16, .rows = 12, .cells = {}};
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const Eigen::Vector2d from_middle((column - 7.5) / 7.5, (row - 5.5) / 5.5);
      const int count = row == 0 ? 3 : 200;
      map.cells.push_back({count * corner_px / std::sqrt(2.0) * from_middle, count});
    }
  }
  return map;
}

ScaleSlope slope_of(double per_100m, double level, int measurements) {
  Rng rng(1);
  ScaleSlope slope;
  slope.per_100m = per_100m;
  slope.sd_per_100m = 0.004;
  slope.length_m = measurements - 1.0;
  slope.measurements = measurements;
  slope.level = level;
  for (int k = 0; k < measurements; ++k) {
    slope.samples.push_back({1.0 * k, level + per_100m * k / 100.0 + 0.01 * rng.normal(), 0.01});
  }
  return slope;
}

CalibrationReport full_report() {
  CalibrationReport report;
  report.title = "Calibration of camera.yaml";
  report.verdict = "there is a new calibration";
  report.adopted = true;
  report.parameters = {{"k1", "", 0.02, 0.0121234, 0.00042, ""},
                       {"cy", "px", 185.0, 185.0, 0.0, "halves of the data are 4.1 standard deviations apart"}};
  report.facts = {{"seen", "300 frames, 298 m, 96 degrees of turning"}};
  report.residuals_before = outward_map(0.3);
  report.residuals_after = outward_map(0.02);
  report.drifts = {{"first", slope_of(0.08, 0.01, 200), slope_of(-0.004, 0.01, 200)}};
  report.camera_before = "k1: 0.02\ncy: 185\n";
  report.camera_after = "k1: 0.0121\ncy: 185\n";
  return report;
}

TEST(EscapeHtml, LeavesNothingThatIsMarkupOrNoCharacter) {
  EXPECT_EQ(escape_html("a<b>&\"'\n\t"), "a&lt;b&gt;&amp;&quot;&#39;\n\t");
  EXPECT_EQ(escape_html("Gr\u00fc\u00dfe \u20ac \U0001F600"), "Gr\u00fc\u00dfe \u20ac \U0001F600");
  const std::string none = "\uFFFD";
  EXPECT_EQ(escape_html("\x01|\x7F|\xFF|\xC3"), none + "|" + none + "|" + none + "|" + none);
  // Too long forms, a surrogate, beyond the last plane: a replacement for each byte.
  EXPECT_EQ(escape_html("\xC0\xAF"), none + none);
  EXPECT_EQ(escape_html("\xE0\x80\xAF"), none + none + none);
  EXPECT_EQ(escape_html("\xED\xA0\x80"), none + none + none);
  EXPECT_EQ(escape_html("\xF4\x90\x80\x80"), none + none + none + none);
}

TEST(Ticks, AreRoundAndInsideTheRange) {
  const internal::Ticks ticks = internal::ticks_between(-0.31, 0.52, 5);
  std::vector<std::string> labels;
  for (const double value : ticks.values) labels.push_back(ticks.label(value));
  EXPECT_THAT(labels, testing::ElementsAre("-0.2", "0.0", "0.2", "0.4"));
  const internal::Ticks pixels = internal::ticks_between(-0.5, 1240.5, 6);
  EXPECT_EQ(pixels.label(pixels.values.front()), "0");
  EXPECT_EQ(pixels.label(pixels.values.back()), "1200");
  EXPECT_EQ(internal::step_label(0.03, 0.015), "0.030");
  EXPECT_EQ(internal::step_label(-1e-17, 0.1), "0.0");
}

TEST(RoundNumbers, AreTheNearestBelowAndAbove) {
  EXPECT_NEAR(internal::round_down(172.0), 150.0, 1e-9);
  EXPECT_NEAR(internal::round_down(0.03), 0.03, 1e-12);
  EXPECT_NEAR(internal::round_up(0.031), 0.04, 1e-12);
  EXPECT_NEAR(internal::round_up(8.5), 10.0, 1e-9);
  EXPECT_NEAR(internal::round_up(0.06), 0.06, 1e-12);
}

TEST(CommonScale, LongestArrowNearlySpansItsCell) {
  const ResidualMap before = outward_map(0.3);
  const ResidualMap after = outward_map(0.02);
  const internal::MapScale scale = internal::common_scale({&before, &after});
  // The top row has too few residuals: the longest are those of the bottom's corners.
  const double longest_px = 0.3;
  EXPECT_LE(scale.magnification * longest_px, 40.0);
  EXPECT_GT(scale.magnification * longest_px, 0.6 * 40.0);
  EXPECT_GE(5.0 * scale.colour_step_px, longest_px);
  EXPECT_LT(5.0 * scale.colour_step_px, 1.6 * longest_px);
}

TEST(CalibrationReport, IsWellFormedAndNeedsNothingElse) {
  const std::string html = calibration_report_html(full_report());
  EXPECT_EQ(what_is_wrong(html), "");
  for (const char* foreign : {"<script", "://", "src=", "href=", "@import", "url("}) {
    EXPECT_THAT(html, Not(HasSubstr(foreign)));
  }
  EXPECT_THAT(html, Not(HasSubstr("nan")));
}

TEST(CalibrationReport, IsTheSameBytesAgain) {
  EXPECT_EQ(calibration_report_html(full_report()), calibration_report_html(full_report()));
}

TEST(CalibrationReport, StatesParametersAsExactlyAsTheyAreKnown) {
  const std::string html = calibration_report_html(full_report());
  EXPECT_THAT(html, HasSubstr("<td>0.02000</td><td>0.01212</td><td>0.00042</td>"));
  EXPECT_THAT(html, HasSubstr("<td>185</td><td>185</td><td>\u2013</td>"));
  EXPECT_THAT(html, HasSubstr("stays as it was: halves of the data are 4.1 standard deviations apart"));
}

TEST(CalibrationReport, DrawsAnArrowForEachCellWithEnoughResiduals) {
  const std::string html = calibration_report_html(full_report());
  EXPECT_EQ(occurrences(html, "class=\"arrow\""), 2 * 16 * 11);
  EXPECT_EQ(occurrences(html, "of 3 residuals"), 2 * 16);
  EXPECT_THAT(html, HasSubstr("The arrows are 100 times as long"));  // 120 would leave the cell of 40 px and 0.3 px
  // Bottom right corner: by 0.3 px to the right and down.
  EXPECT_THAT(html, HasSubstr("<title>right 0.212 px, down 0.212 px, of 200 residuals</title>"));
}

TEST(CalibrationReport, ThinsManyMeasurementsAndSaysSo) {
  CalibrationReport report = full_report();
  report.drifts = {{"long", slope_of(0.01, 0.0, 3000), std::nullopt}};
  report.drifts[0].before->samples[1500].log_ratio = 2.0;
  report.drifts[0].before->samples[1501].log_ratio = std::numeric_limits<double>::quiet_NaN();
  const std::string html = calibration_report_html(report);
  EXPECT_EQ(what_is_wrong(html), "");
  const int marks = occurrences(html, "<circle class=\"before\"") - 1;  // one is the key's
  EXPECT_GT(marks, 200);
  EXPECT_LE(marks, 250);
  std::smatch said;
  ASSERT_TRUE(
      std::regex_search(html, said, std::regex(R"((\d+) of (\d+) are drawn\. (\d+) measurements lie outside)")));
  EXPECT_EQ(std::stoi(said[1]), marks);
  EXPECT_EQ(std::stoi(said[2]) + std::stoi(said[3]), 3000);
  EXPECT_GE(std::stoi(said[3]), 2);
  EXPECT_THAT(html, Not(HasSubstr("nan")));
}

TEST(CalibrationReport, MarksTheLinesOfTheCameraFileThatDiffer) {
  const std::string html = calibration_report_html(full_report());
  EXPECT_THAT(html, HasSubstr("<pre><mark>k1: 0.02\n</mark>cy: 185\n</pre>"));
  EXPECT_THAT(html, HasSubstr("<pre><mark>k1: 0.0121\n</mark>cy: 185\n</pre>"));
}

TEST(CalibrationReport, LeavesOutWhatThereIsNothingToSayOf) {
  CalibrationReport report;
  report.title = "Calibration";
  report.verdict = "the calibration stays as it is";
  const std::string html = calibration_report_html(report);
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, Not(HasSubstr("<h2>")));
  EXPECT_THAT(html, HasSubstr("<p class=\"verdict\">the calibration stays as it is</p>"));
}

TEST(CalibrationReport, MapsWithoutEnoughResidualsHaveNoArrows) {
  CalibrationReport report = full_report();
  for (auto* map : {&report.residuals_before, &report.residuals_after}) {
    for (ResidualMap::Cell& cell : (*map)->cells) cell = {};
  }
  const std::string html = calibration_report_html(report);
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_EQ(occurrences(html, "class=\"arrow\""), 0);
  EXPECT_THAT(html, HasSubstr("too few for a map"));
}

TEST(CalibrationReport, TextOfOthersIsNoMarkup) {
  CalibrationReport report = full_report();
  const std::string nasty = "\"><b onclick='x'>&\xFF";
  report.title = report.verdict = report.camera_before = nasty;
  report.facts = {{nasty, nasty}};
  report.parameters[0].name = report.parameters[0].unit = report.parameters[1].reason = nasty;
  report.drifts[0].drive = nasty;
  const std::string html = calibration_report_html(report);
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, Not(HasSubstr("<b ")));
}

TEST(CalibrationReport, IsWrittenWhole) {
  const internal::TempFolder folder;
  ASSERT_TRUE(write_calibration_report(folder / "report.html", full_report()));
  EXPECT_EQ(read_text(folder / "report.html").value(), calibration_report_html(full_report()));
  const auto nowhere = write_calibration_report(folder / "none/report.html", full_report());
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code, ErrorCode::kIo);
}

}  // namespace
}  // namespace groundscale
