#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/experiments/calibration_report_internal.hpp"

namespace groundscale::internal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

MeasuredTrial trial(const std::string& drive, double radial_error, double row_error, double radial_sd = 0.001,
                    double row_sd = 0.5) {
  MeasuredTrial made;
  made.drive = drive;
  made.start = {.radial = -0.02, .row_px = 5.0};
  made.adopted = true;
  made.verdict = "calibrated";
  made.figures = {{"radial_start", -0.02},          {"row_start", 5.0},
                  {"radial_error", radial_error},   {"radial_error_px", 500.0 * radial_error},
                  {"radial_sd", radial_sd},         {"radial_in_sd", radial_error / radial_sd},
                  {"row_error", row_error},         {"row_sd", row_sd},
                  {"row_in_sd", row_error / row_sd}};
  return made;
}

MeasuredTrial refused(const std::string& drive) {
  MeasuredTrial made;
  made.drive = drive;
  made.start = {.radial = -0.02, .row_px = 5.0};
  made.verdict = "the calibration stays as it is: too little";
  made.figures = {{"radial_start", -0.02}, {"row_start", 5.0}, {"radial_error", -0.02}, {"row_error", 5.0}};
  return made;
}

std::vector<std::string> words(const MeasuredPart& part) {
  std::vector<std::string> all;
  for (const Aim& aim : calibration_aims(part)) all.push_back(in_words(aim));
  return all;
}

TEST(CalibrationAims, OfDrivesAreJudgedOnTheWorst) {
  EXPECT_THAT(words({"drives", "", {trial("city", 0.0004, -1.2), trial("05", -0.0015, 0.3)}}),
              ElementsAre("met: error of k1 at most 0.002 on each drive: 0.0015 on 05 from k1 -0.02, cy +5 px",
                          "not met: error of cy, px, at most 1 on each drive: 1.2 on city from k1 -0.02, cy +5 px"));
}

TEST(CalibrationAims, OfDrivesCountTheStartWhereNothingWasFound) {
  EXPECT_THAT(words({"drives", "", {trial("city", 0.0004, 0.2), refused("07")}}),
              ElementsAre(HasSubstr("not met: error of k1"), HasSubstr("5 on 07")));
}

TEST(CalibrationAims, OfAFisheyeAreInPixelsOfTheCorners) {
  EXPECT_THAT(words({"fisheye", "", {trial("city", 0.0015, 0.2)}}).front(),
              testing::StartsWith("met: error of k1, px in the corners, at most 1 on each drive: 0.75 on city"));
}

TEST(CalibrationAims, OfSeedsCountErrorsWithinTwoSd) {
  MeasuredPart part{"seeds", "", {}};
  for (int k = 0; k < 10; ++k) part.trials.push_back(trial("city", k % 2 == 0 ? 0.001 : -0.001, 0.5));
  EXPECT_THAT(words(part), ElementsAre("met: of 20 errors at least 17 within 2 sd: 20 (k1 10, cy 10)",
                                       "met: rms of error / sd from 0.6 to 1.4: 1.00 (k1 1.00, cy 1.00)"));
  for (int k = 0; k < 4; ++k) part.trials[static_cast<std::size_t>(k)] = trial("city", 0.003, 0.0);
  EXPECT_THAT(words(part), ElementsAre(HasSubstr("not met: of 20 errors at least 17 within 2 sd: 16 (k1 6, cy 10)"),
                                       HasSubstr("not met: rms of error / sd from 0.6 to 1.4: 1.55")));
}

TEST(CalibrationAims, OfSeedsCountWhatWasNotFoundAsWrong) {
  const MeasuredPart part{"seeds", "", {trial("1", 0.001, 0.5), refused("2")}};
  EXPECT_THAT(words(part).front(), HasSubstr("not met: of 4 errors at least 4 within 2 sd: 2"));
}

TEST(CalibrationAims, OfAStraightAreThatNothingChanges) {
  EXPECT_THAT(words({"straight", "", {refused("straight")}}),
              ElementsAre("met: nothing changes: 0 of 1 calibrations changed something"));
  EXPECT_THAT(words({"straight", "", {refused("straight"), trial("straight", 0.001, 0.1)}}),
              ElementsAre("not met: nothing changes: 1 of 2 calibrations changed something"));
}

TEST(CalibrationAims, ArentThereWhereAPartOnlyMeasures) {
  EXPECT_THAT(words({"range", "", {trial("city", 0.1, 9.0)}}), IsEmpty());
  EXPECT_THAT(words({"seeds", "", {}}), ElementsAre(HasSubstr("nothing to measure"), HasSubstr("nothing to measure")));
}

TEST(CalibrationTable, HasARowACalibrationAndEmptyCells) {
  const std::string csv = calibration_table({trial("city", 0.0004, -1.2), refused("07")}).csv();
  EXPECT_THAT(csv, testing::StartsWith("drive,start,radial_start,radial_error,radial_sd,"));
  EXPECT_THAT(csv, HasSubstr("\ncity,\"k1 -0.02, cy +5 px\",-0.02,0.0004,0.001,0.4,"));
  EXPECT_THAT(csv, HasSubstr("\n07,\"k1 -0.02, cy +5 px\",-0.02,-0.02,,,"));
}

TEST(CalibrationReport, HasASectionAPartAndSaysWhatIsMissing) {
  ExperimentRequest request;
  request.command = "groundscale experiment calibration --output out";
  const std::string text =
      calibration_report({{"drives", "How near.", {trial("city", 0.0004, 0.2)}}, {"range", "How far.", {}}},
                         {"groundscale simulate --output city"}, {"2 calibrations are not done yet"}, request);
  EXPECT_THAT(text, HasSubstr("    groundscale experiment calibration --output out\n"));
  EXPECT_THAT(text, HasSubstr("- 2 calibrations are not done yet\n"));
  EXPECT_THAT(text, HasSubstr("## `drives`\n\nHow near. With full precision: `drives.csv`.\n\n| drive | start |"));
  EXPECT_THAT(text, HasSubstr("- met: error of k1"));
  EXPECT_THAT(text, HasSubstr("    groundscale simulate --output city\n"));
  EXPECT_THAT(text, Not(HasSubstr("## `range`"))) << "nothing of it is there";
}

}  // namespace
}  // namespace groundscale::internal
