#include "groundscale/evaluation/evaluate.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/evaluation/test_drives_internal.hpp"

namespace groundscale {
namespace {

using internal::drive_of;
using internal::straight_drive;
using internal::stretched;
using internal::with_times;
using testing::HasSubstr;

constexpr double kTolerance = 1e-12;

PairedDrive drive_from(const Trajectory& estimate, const Trajectory& truth) {
  PairedDrive drive;
  drive.estimate = estimate;
  drive.truth = truth;
  return drive;
}

Evaluation evaluation_of(const PairedDrive& drive) {
  const auto evaluation = evaluate(drive, {3.0});
  EXPECT_TRUE(evaluation) << (evaluation ? "" : evaluation.error().message);
  return evaluation ? *evaluation : Evaluation{};
}

FrameRow measured(int frame, double raw_step_m, double raw_sd_m, const char* reason = "") {
  FrameRow row;
  row.frame = frame;
  row.raw_step_m = raw_step_m;
  row.raw_step_sd_m = raw_sd_m;
  row.reason = reason;
  return row;
}

/// Frames 20 to 26. True steps 0.1 (stands), then 1 m. Accepted: frames 22, 23, 25; refused: 24; nothing: 20, 21, 26.
/// Filtered from frame 22 on, but not in 26.
PairedDrive small_run() {
  PairedDrive drive = drive_from(drive_of({0, 0, 0, 0, 0, 0}, {0.1, 1.0, 1.01, 1.02, 1.03, 1.10}),
                                 with_times(drive_of({0, 0, 0, 0, 0, 0}, {0.1, 1, 1, 1, 1, 1}), 0.1));
  FrameRow first, second, last;
  first.frame = 20;
  second.frame = 21;
  last.frame = 26;
  drive.frames = {first,
                  second,
                  measured(22, 1.04, 0.03),
                  measured(23, 0.94, 0.02),
                  measured(24, 7.0, 0.1, "normal"),
                  measured(25, 1.10, 0.04),
                  last};
  drive.frames[2].step_sd_m = 0.01;
  drive.frames[3].step_sd_m = 0.01;
  drive.frames[4].step_sd_m = 0.011;
  drive.frames[5].step_sd_m = 0.01;
  for (int k = 2; k < 7; ++k) drive.frames[k].online_step_m = 1.05;
  return drive;
}

TEST(Evaluate, AStraightPathTwoPercentTooLongHasThatScaleAndNoSpreadOrDrift) {
  const Trajectory truth = straight_drive(201, 1.0);
  const auto evaluation = evaluate(drive_from(stretched(truth, 1.02), truth), kitti_lengths_m());
  ASSERT_TRUE(evaluation);
  EXPECT_EQ(evaluation->moving_steps, 200);
  EXPECT_NEAR(evaluation->scale.all->bias, 0.02, kTolerance);
  EXPECT_NEAR(evaluation->scale.all->spread, 0.0, kTolerance);
  EXPECT_NEAR(evaluation->scale.all->mean, 0.02, kTolerance);
  EXPECT_EQ(evaluation->scale.all->within_10_percent, 1.0);
  EXPECT_NEAR(evaluation->scale.drift->log_per_m, 0.0, kTolerance);
  EXPECT_NEAR(evaluation->path.estimated_m / evaluation->path.true_m, 1.02, kTolerance);
  EXPECT_NEAR(evaluation->path.kitti.all->t_rel, 0.0202, kTolerance);
  EXPECT_NEAR(evaluation->path.absolute->sim3_scale, 1.0 / 1.02, kTolerance);
  EXPECT_FALSE(evaluation->online_scale || evaluation->raw_scale || evaluation->coverage);
}

TEST(Evaluate, StepsThatStandCountForTheLengthAndNotForTheScale) {
  const Evaluation evaluation =
      evaluation_of(drive_from(drive_of({0, 0, 0}, {0.5, 1, 1}), drive_of({0, 0, 0}, {0.1, 1, 1})));
  EXPECT_EQ(evaluation.moving_steps, 2);
  EXPECT_NEAR(evaluation.scale.all->mean, 0.0, kTolerance);
  EXPECT_NEAR(evaluation.path.estimated_m, 2.5, kTolerance);
  EXPECT_NEAR(evaluation.path.true_m, 2.1, kTolerance);
  EXPECT_EQ(evaluation.path.rotations, 3);
}

TEST(Evaluate, StraightsAndTurnsAreJudgedApartByTheTruthsYaw) {
  // Ten steps straight at ratio 1.01, ten in a turn of 3 deg each at 0.9. The mean over five steps makes a turn of the
  // last step before (2/5 of 3 deg at step 9: 6 deg / 5 = 1.2) but not of step 8 (0.6).
  std::vector<double> yaws_deg(10, 0.0), steps_m(10, 1.01);
  yaws_deg.insert(yaws_deg.end(), 10, 3.0);
  steps_m.insert(steps_m.end(), 10, 0.9);
  const Evaluation evaluation =
      evaluation_of(drive_from(drive_of(yaws_deg, steps_m), drive_of(yaws_deg, std::vector<double>(20, 1.0))));
  EXPECT_EQ(evaluation.turn_steps, 11);
  EXPECT_EQ(evaluation.scale.straight->steps, 9);
  EXPECT_EQ(evaluation.scale.turn->steps, 11);
  EXPECT_NEAR(evaluation.scale.straight->bias, 0.01, kTolerance);
  EXPECT_NEAR(evaluation.scale.turn->bias, -0.1, kTolerance);
  EXPECT_NEAR(evaluation.scale.turn->rms_log,
              std::sqrt((10.0 * std::pow(std::log(0.9), 2) + std::pow(std::log(1.01), 2)) / 11.0), kTolerance);
}

TEST(Evaluate, RawFiguresAreOverAcceptedMeasurementsOfMovingSteps) {
  const Evaluation evaluation = evaluation_of(small_run());
  ASSERT_TRUE(evaluation.raw_scale);
  EXPECT_EQ(evaluation.raw_scale->steps, 3);  // 1.04, 0.94, 1.10
  EXPECT_NEAR(evaluation.raw_scale->all->bias, 0.04, kTolerance);
  EXPECT_NEAR(evaluation.raw_scale->all->spread, 0.06 / 1.04, kTolerance);     // 0, .06, .10
  EXPECT_NEAR(evaluation.raw_scale->all->p95, 0.06 + 0.9 * 0.04, kTolerance);  // .04, .06, .10 at 1.9
}

TEST(Evaluate, CoverageIsTheShareOfMovingStepsAndSaysWhereItBegins) {
  const auto coverage = evaluation_of(small_run()).coverage;
  ASSERT_TRUE(coverage);
  EXPECT_EQ(coverage->accepted.of, 5);  // the step into frame 21 stands
  EXPECT_EQ(coverage->accepted.count, 3);
  EXPECT_EQ(coverage->filtered.of, 5);
  EXPECT_EQ(coverage->filtered.count, 4);
  EXPECT_EQ(coverage->first_accepted_frame, 22);
  EXPECT_EQ(coverage->moving_steps_before_first, 0);
  EXPECT_EQ(coverage->filtered_after_first.of, 5);
}

TEST(Evaluate, MovingStepsBeforeTheFirstAcceptedFrameAreCounted) {
  PairedDrive drive = small_run();
  drive.frames[2].reason = "few inliers";
  drive.frames[2].step_sd_m.reset();
  const auto coverage = evaluation_of(drive).coverage;
  EXPECT_EQ(coverage->first_accepted_frame, 23);
  EXPECT_EQ(coverage->moving_steps_before_first, 1);
  EXPECT_EQ(coverage->filtered.of, 5);
  EXPECT_EQ(coverage->filtered_after_first.of, 4);
  EXPECT_EQ(coverage->filtered_after_first.count, 3);
}

TEST(Evaluate, ShareWithinTwoStandardDeviationsIsOfTheStepsThatHaveOne) {
  const auto coverage = evaluation_of(small_run()).coverage;
  EXPECT_EQ(coverage->within_2_sd.all.of, 4);  // errors 0, .01, .02, .03 against .02, .02, .022, .02
  EXPECT_EQ(coverage->within_2_sd.all.count, 3);
  EXPECT_EQ(coverage->raw_within_2_sd.of, 3);  // errors .04, -.06, .10 against .06, .04, .08
  EXPECT_EQ(coverage->raw_within_2_sd.count, 1);
}

TEST(Evaluate, OnlineFiguresComeFromTheStepsOfTheTableWhereThereIsNoOnlineTrajectory) {
  const Evaluation evaluation = evaluation_of(small_run());
  ASSERT_TRUE(evaluation.online_scale);
  EXPECT_EQ(evaluation.online_scale->steps, 5);
  EXPECT_NEAR(evaluation.online_scale->all->bias, 0.05, kTolerance);
  EXPECT_FALSE(evaluation.online_path);
}

TEST(Evaluate, OnlineFiguresComeFromTheOnlineTrajectoryWhereItIsThere) {
  PairedDrive drive = small_run();
  drive.online = stretched(drive.truth, 0.97);
  const Evaluation evaluation = evaluation_of(drive);
  EXPECT_NEAR(evaluation.online_scale->all->bias, -0.03, kTolerance);
  ASSERT_TRUE(evaluation.online_path);
  EXPECT_NEAR(evaluation.online_path->estimated_m, 0.97 * 5.1, kTolerance);
  EXPECT_NEAR(evaluation.online_path->kitti.all->t_rel, 0.03 * 3.1 / 3.0, kTolerance);  // row 4 is past 3 m
}

TEST(Evaluate, ATruthThatStandsStillIsAnErrorThatSaysSo) {
  const auto still = evaluate(drive_from(straight_drive(5, 1.0), straight_drive(5, 0.0)), {3.0});
  ASSERT_FALSE(still);
  EXPECT_EQ(still.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(still.error().message,
              AllOf(HasSubstr("stands still"), HasSubstr("none of its 4 steps is longer than 0.2 m")));
  const auto slow = evaluate(drive_from(straight_drive(5, 1.0), with_times(straight_drive(5, 1.0), 1.0)), {3.0});
  EXPECT_THAT(slow.error().message, HasSubstr("faster than 2 m/s"));
}

TEST(Evaluate, AnEstimateThatStandsStillHasALengthRatioOfZeroAndNoScaleFigures) {
  const Evaluation evaluation = evaluation_of(drive_from(straight_drive(9, 0.0), straight_drive(9, 1.0)));
  EXPECT_EQ(evaluation.path.estimated_m, 0.0);
  EXPECT_EQ(evaluation.scale.steps, 8);
  EXPECT_FALSE(evaluation.scale.all);
  EXPECT_FALSE(evaluation.path.absolute);
}

}  // namespace
}  // namespace groundscale
