#include "groundscale/odometry/pairwise.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"
#include "synthetic_drive.hpp"

namespace groundscale {
namespace {

constexpr int kFrames = 14;

/// Rendered once for all tests of this file.
const std::vector<Image>& street() {
  static const std::vector<Image> images = [] {
    const SyntheticDrive drive;
    std::vector<Image> rendered;
    for (int k = 0; k < kFrames; ++k) rendered.push_back(drive.render(drive.step_m * k));
    return rendered;
  }();
  return images;
}

/// @param slow_frames  So many of the first are a second apart, as if driven slowly; the others a tenth.
PairwiseOdometry run(const std::vector<Image>& images, const OdometryOptions& options = {},
                     std::size_t slow_frames = 0) {
  const SyntheticDrive drive;
  CameraSetup setup;
  setup.camera = *PinholeCamera::create(
      {.fx = drive.focal_px, .fy = drive.focal_px, .cx = drive.cx(), .cy = drive.cy()}, drive.width, drive.height);
  setup.height_m = drive.camera_height_m;
  auto odometry = PairwiseOdometry::create(setup, options);
  GS_CHECK(odometry.has_value(), "the street is in view");
  for (std::size_t k = 0; k < images.size(); ++k) {
    Frame frame;
    frame.index = static_cast<int>(k);
    frame.time_s = 0.1 * static_cast<double>(k) + 0.9 * static_cast<double>(std::min(k, slow_frames));
    frame.image = images[k];
    if (frame.image.empty()) frame.problem = "unreadable";
    odometry->advance(frame);
  }
  odometry->finish();
  return std::move(*odometry);
}

void expect_numbers_everywhere(const PairwiseOdometry& odometry) {
  const auto finals = odometry.final_poses();
  ASSERT_EQ(finals.size(), odometry.results().size());
  for (std::size_t k = 0; k < finals.size(); ++k) {
    const FrameResult& result = odometry.results()[k];
    EXPECT_TRUE(finals[k].rotation.allFinite() && finals[k].translation.allFinite()) << k;
    EXPECT_TRUE(odometry.online_poses()[k].translation.allFinite()) << k;
    EXPECT_TRUE(std::isfinite(result.step_m) && std::isfinite(result.online_step_m)) << k;
    EXPECT_TRUE(std::isfinite(result.step_sd) && std::isfinite(result.raw_over_online.value_or(0.0))) << k;
  }
}

TEST(PairwiseOdometry, FindsTheStepOfAStreetInMetres) {
  const PairwiseOdometry odometry = run(street());
  expect_numbers_everywhere(odometry);
  EXPECT_TRUE(odometry.scaled());
  std::vector<double> steps;
  for (const FrameResult& result : odometry.results()) {
    if (result.state == FrameState::kMoving) steps.push_back(result.step_m);
  }
  ASSERT_EQ(steps.size(), kFrames - 1U);
  std::sort(steps.begin(), steps.end());
  // A single measurement on an exact plane is within about 2 %; the smoothed median of 13 is better.
  EXPECT_NEAR(steps[steps.size() / 2] / SyntheticDrive{}.step_m, 1.0, 0.015);
}

TEST(PairwiseOdometry, StandsStillOnIdenticalFrames) {
  const PairwiseOdometry odometry = run(std::vector<Image>(4, street().front()));
  expect_numbers_everywhere(odometry);
  for (const FrameResult& result : odometry.results()) EXPECT_EQ(result.state, FrameState::kStill);
  EXPECT_TRUE(odometry.final_poses().back().translation.isZero());
}

TEST(PairwiseOdometry, StandsStillOnBlackFrames) {
  const SyntheticDrive drive;
  const PairwiseOdometry odometry = run(std::vector<Image>(4, Image(drive.width, drive.height)));
  expect_numbers_everywhere(odometry);
  for (const FrameResult& result : odometry.results()) EXPECT_EQ(result.state, FrameState::kStill);
}

TEST(PairwiseOdometry, BridgesAnUnreadableFrameAndGoesOn) {
  std::vector<Image> images = street();
  images[8] = {};
  const PairwiseOdometry odometry = run(images);
  expect_numbers_everywhere(odometry);
  EXPECT_EQ(odometry.results()[8].state, FrameState::kBridged);
  EXPECT_EQ(odometry.results()[8].reason, "unreadable");
  for (const std::size_t k : {7U, 9U, 10U, 11U}) EXPECT_EQ(odometry.results()[k].state, FrameState::kMoving) << k;
  const auto poses = odometry.final_poses();
  // Constant velocity is the truth here, so a gap costs no more than the scale does: 5 % is three sd of one
  // measurement.
  EXPECT_NEAR((poses[11].translation - poses[7].translation).norm(), 4.0 * SyntheticDrive{}.step_m,
              0.05 * 4.0 * SyntheticDrive{}.step_m);
}

TEST(PairwiseOdometry, GoesOnAtConstantSpeedHoweverLongNothingIsSeen) {
  std::vector<Image> images = street();
  constexpr int kGap = 14;  // longer than a bridge may be
  images.insert(images.end(), kGap, Image());
  const PairwiseOdometry odometry = run(images);
  expect_numbers_everywhere(odometry);
  EXPECT_EQ(odometry.results().back().state, FrameState::kLost);
  const auto poses = odometry.final_poses();
  const double step = SyntheticDrive{}.step_m;
  // The last step goes on: 5 % is three sd of a measurement.
  EXPECT_NEAR((poses.back().translation - poses[kFrames - 1].translation).norm(), kGap * step, 0.05 * kGap * step);
}

TEST(PairwiseOdometry, RawStepsFromBeforeTheScaleWasKnownAreMetres) {
  // The first measurements are refused for their speed, 0.8 m/s; what they measured is told all the same.
  OdometryOptions options;
  options.ground.gates.min_speed_mps = 2.0;
  const PairwiseOdometry odometry = run(street(), options, /*slow_frames=*/4);
  ASSERT_TRUE(odometry.scaled());
  int refused = 0;
  for (const FrameResult& result : odometry.results()) {
    if (!result.raw_over_online) continue;
    if (!result.reason.empty()) ++refused;
    // A single measurement is within about 2 %.
    EXPECT_NEAR(*result.raw_over_online * result.online_step_m / SyntheticDrive{}.step_m, 1.0, 0.08) << result.frame;
  }
  EXPECT_GE(refused, 3);
}

TEST(PairwiseOdometry, InAPolygonAllRoadPointsCountTheSame) {
  // A region beside the vehicle has no driven path to weight its points by: with a strip the weights matter.
  const auto last_raw = [](double weight_sd_m, const std::vector<double>& polygon_px) {
    OdometryOptions options;
    options.road.region.weight_sd_m = weight_sd_m;
    options.road.region.polygon_px = polygon_px;
    const PairwiseOdometry odometry = run({street().begin(), street().begin() + 4}, options);
    return odometry.results().back().raw_over_online.value_or(0.0);
  };
  const std::vector<double> lower_left{60.0, 230.0, 250.0, 125.0, 310.0, 125.0, 310.0, 230.0};
  EXPECT_GT(last_raw(0.3, lower_left), 0.0);
  EXPECT_EQ(last_raw(0.3, lower_left), last_raw(3.0, lower_left));
  EXPECT_NE(last_raw(0.3, {}), last_raw(3.0, {}));
}

TEST(PairwiseOdometry, IsTheSameToTheLastBitWhenRunAgain) {
  const PairwiseOdometry a = run(street());
  const PairwiseOdometry b = run(street());
  const auto poses_a = a.final_poses();
  const auto poses_b = b.final_poses();
  for (std::size_t k = 0; k < poses_a.size(); ++k) {
    EXPECT_EQ(poses_a[k].rotation, poses_b[k].rotation) << k;
    EXPECT_EQ(poses_a[k].translation, poses_b[k].translation) << k;
    EXPECT_EQ(a.online_poses()[k].translation, b.online_poses()[k].translation) << k;
  }
}

}  // namespace
}  // namespace groundscale
