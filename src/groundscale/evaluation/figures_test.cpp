#include "groundscale/evaluation/figures.hpp"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "groundscale/evaluation/test_drives_internal.hpp"

namespace groundscale {
namespace {

using internal::straight_drive;
using internal::stretched;
using internal::with_times;
using testing::HasSubstr;
using testing::Not;

PairedDrive drive_of_rows(int rows, bool run) {
  PairedDrive drive;
  const Trajectory truth = straight_drive(rows, 1.0);
  drive.estimate = stretched(truth, 1.02);
  drive.truth = run ? with_times(truth, 0.1) : truth;
  drive.rows_of_truth = 4541;
  for (int row = 0; row < rows; ++row) {
    drive.truth_rows.push_back(15 + row);
    if (!run) continue;
    FrameRow frame;
    frame.frame = 15 + row;
    frame.raw_step_m = 0.99;
    drive.frames.push_back(frame);
  }
  return drive;
}

Evaluation evaluation_of(const PairedDrive& drive) {
  const auto evaluation = evaluate(drive, kitti_lengths_m());
  EXPECT_TRUE(evaluation);
  return *evaluation;
}

TEST(Figures, NamesAreUniqueAndAllOfTheDesignsAreThere) {
  std::map<std::string, Figure> by_name;
  for (const FigureGroup& group : figures_of(evaluation_of(drive_of_rows(120, true)))) {
    for (const Figure& figure : group.figures) {
      EXPECT_TRUE(by_name.emplace(figure.name, figure).second) << figure.name;
    }
  }
  for (const char* name : {"scale_bias",
                           "scale_spread",
                           "within_10_percent",
                           "scale_error_mean",
                           "scale_error_p95",
                           "length_ratio",
                           "raw_scale_bias",
                           "raw_scale_spread",
                           "raw_p95",
                           "raw_rms_turn",
                           "scale_bias_straight",
                           "scale_spread_turn",
                           "raw_scale_bias_turn",
                           "coverage",
                           "coverage_filtered",
                           "first_accepted_frame",
                           "scale_drift",
                           "rotation_error",
                           "t_rel",
                           "r_rel",
                           "ate_se3",
                           "ate_sim3",
                           "sim3_scale",
                           "online_scale_bias"}) {
    EXPECT_TRUE(by_name.contains(name)) << name;
  }
  EXPECT_NEAR(*by_name["scale_bias"].value, 2.0, 1e-9);
  EXPECT_EQ(by_name["scale_bias"].unit, "%");
  EXPECT_NEAR(*by_name["raw_scale_bias"].value, -1.0, 1e-9);
  EXPECT_NEAR(*by_name["coverage"].value, 100.0, 1e-9);
  EXPECT_EQ(*by_name["first_accepted_frame"].value, 15.0);
}

TEST(Figures, TheTableSaysWhatWasComparedAndHowMuchStandsBehindEachNumber) {
  const PairedDrive drive = drive_of_rows(120, false);
  const std::string table = evaluation_table({"e.kitti", "t.txt", 15, 0}, drive, evaluation_of(drive));
  EXPECT_THAT(table, HasSubstr("t.txt: rows 15 to 134 of 4541"));
  EXPECT_THAT(table, HasSubstr("119 of 119 steps: true step above 0.2 m, no times"));
  EXPECT_THAT(table, testing::ContainsRegex("scale_bias +\\+2\\.000 % +119 steps"));
  EXPECT_THAT(table, testing::ContainsRegex("t_rel +2\\.0200 % +2 segments"));  // starts 0 and 10
  EXPECT_THAT(table, testing::ContainsRegex("scale_bias_turn +- % +0 steps"));
  EXPECT_THAT(table, Not(HasSubstr("nan")));
  EXPECT_THAT(table, Not(HasSubstr("coverage")));
}

TEST(Figures, APathTooShortForEverySegmentSaysSo) {
  const PairedDrive drive = drive_of_rows(50, false);
  EXPECT_THAT(evaluation_table({"e", "t", 0, 0}, drive, evaluation_of(drive)),
              testing::ContainsRegex("t_rel +- % +0 segments +path too short: --lengths"));
}

TEST(Figures, WhatIsNotFiniteIsADashAndNull) {
  PairedDrive drive = drive_of_rows(120, true);
  drive.frames[7].raw_step_m = 0.0;  // its logarithm is minus infinity
  const Evaluation evaluation = evaluation_of(drive);
  EXPECT_THAT(evaluation_table({"run", "t", 0, 0}, drive, evaluation),
              testing::ContainsRegex("raw_rms +- % +119 steps"));
  const auto json = nlohmann::json::parse(evaluation_json({"run", "t", 0, 0}, drive, evaluation));
  EXPECT_TRUE(json["figures"]["raw_rms"]["value"].is_null());
}

TEST(Figures, JsonHoldsTheSameFiguresInFullAndNullWhereThereIsNone) {
  const PairedDrive drive = drive_of_rows(120, true);
  const Evaluation evaluation = evaluation_of(drive);
  const auto json = nlohmann::json::parse(evaluation_json({"run", "t.txt", 0, 0}, drive, evaluation));
  EXPECT_EQ(json["truth"]["first_row"], 15);
  EXPECT_EQ(json["figures"]["t_rel"]["value"].get<double>(), 100.0 * evaluation.path.kitti.all->t_rel);
  EXPECT_EQ(json["figures"]["t_rel"]["unit"], "%");
  EXPECT_EQ(json["figures"]["t_rel"]["count"], 2);
  EXPECT_EQ(json["figures"]["t_rel"]["of"], "segments");
  EXPECT_TRUE(json["figures"]["scale_bias_turn"]["value"].is_null());
}

}  // namespace
}  // namespace groundscale
