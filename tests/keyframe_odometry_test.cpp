#include "groundscale/odometry/keyframe.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/odometry/run_writer.hpp"
#include "synthetic_drive.hpp"

namespace groundscale {
namespace {

CameraSetup camera_of(const SyntheticDrive& drive) {
  CameraSetup setup;
  setup.camera = *PinholeCamera::create(
      {.fx = drive.focal_px, .fy = drive.focal_px, .cx = drive.cx(), .cy = drive.cy()}, drive.width, drive.height);
  setup.height_m = drive.camera_height_m;
  return setup;
}

/// rms |pixel2 - project(H ray1)| of the road's inliers by the street's true plane and steps.
double true_transfer_rms_px(const FrameDetails& details, const SyntheticDrive& drive, const Camera& camera) {
  // Straight on, by as many whole steps as the view lies behind.
  const double steps = std::round(details.cam_from_reference.translation.norm() / drive.step_m);
  const RigidTransform motion{Eigen::Matrix3d::Identity(), {0.0, 0.0, -steps * drive.step_m}};
  const Eigen::Matrix3d homography = homography_of_plane({{0.0, 1.0, 0.0}, drive.camera_height_m}, motion);
  double squares = 0.0;
  for (const int i : details.road_inliers) {
    const Match& match = details.road_matches.at(static_cast<std::size_t>(i));
    squares += (match.pixel2 - camera.project(homography * camera.ray(match.pixel1).value()).value()).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(details.road_inliers.size()));
}

TEST(KeyframeOdometry, SaysWhatAFrameWasMeasuredFrom) {
  const SyntheticDrive drive;
  const CameraSetup setup = camera_of(drive);
  auto odometry = KeyframeOdometry::create(setup, {}).value();
  int measured = 0;
  constexpr int kFrames = 16;
  for (int k = 0; k < kFrames; ++k) {
    Frame frame;
    frame.index = k;
    frame.time_s = 0.1 * k;
    frame.image = drive.render(drive.step_m * k);
    const FrameResult& result = odometry->advance(frame);
    const FrameDetails details = odometry->details();
    ASSERT_EQ(details.inliers.size(), static_cast<std::size_t>(result.inliers)) << k;
    ASSERT_EQ(details.matches.size(), static_cast<std::size_t>(result.matches)) << k;
    if (!result.map_scale || details.road_inliers.empty()) continue;
    ++measured;
    EXPECT_FALSE(details.reference_image.empty()) << k;
    // The map's plane and step are as near to the true ones as not to matter beside what a point is tracked by.
    EXPECT_NEAR(result.road_rms_px, true_transfer_rms_px(details, drive, *setup.camera), 0.1) << k;
    EXPECT_GT(result.road_rms_px, 0.0) << k;
  }
  ASSERT_GE(measured, 5);
  RunSummary summary;
  add_figures(*odometry, summary);
  EXPECT_GT(summary.matching.road_rms_px, 0.0);
  EXPECT_LT(summary.matching.road_rms_px, 0.5);  // points are tracked to a few tenths of a pixel
}

}  // namespace
}  // namespace groundscale
