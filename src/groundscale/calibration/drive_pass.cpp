#include "groundscale/calibration/drive_pass.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/odometry/odometry.hpp"
#include "groundscale/odometry/turning.hpp"

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::size_t kLeastFrames = 20;  // for a median

/// Pitch and roll by the ground, yaw by the direction of motion, where the vehicle goes straight.
std::optional<Mounting> straight_mounting(const std::vector<FrameResult>& results,
                                          const std::vector<RigidTransform>& world_from_cam) {
  constexpr double kStraightDeg = 0.5;  // a frame
  std::vector<double> pitches, rolls, yaws;
  for (std::size_t k = 1; k < results.size(); ++k) {
    if (!results[k].accepted() || !results[k].pitch_rad || !results[k].roll_rad) continue;
    const RigidTransform step = world_from_cam[k - 1].inverse() * world_from_cam[k];
    if (rotation_angle(step.rotation) > kStraightDeg * kDegree) continue;
    pitches.push_back(*results[k].pitch_rad);
    rolls.push_back(*results[k].roll_rad);
    yaws.push_back(std::atan2(-step.translation.x(), step.translation.z()));
  }
  if (pitches.size() < kLeastFrames) return std::nullopt;
  return Mounting{median(std::move(pitches)), median(std::move(rolls)), median(std::move(yaws))};
}

}  // namespace

Result<DrivePass> drive_pass(const CalibrationDrive& drive, const CameraSetup& setup, const OdometryOptions& odometry,
                             const DriveRecorderOptions& views, const PassProgress& progress, int max_frames) {
  auto sequence = drive.open();
  if (!sequence) return sequence.error();
  OdometryOptions options = odometry;
  options.odometry.mode = OdometryMode::kKeyframe;
  options.odometry.scale_correction = ScaleCorrection::kNone;
  options.camera.refine = CameraRefinement::kNone;  // the pass says what this camera does
  options.scale.speed.file.clear();                 // which belongs to one drive
  auto made = make_odometry(setup, options);
  if (!made) return made.error();
  Odometry& driven = **made;
  DriveRecorder recorder(views);
  DrivePass pass;
  while (const auto frame = (*sequence)->next()) {
    const FrameResult& result = driven.advance(*frame);
    if (result.state == FrameState::kMoving) recorder.add(pass.frames, result.frame, driven.tracks());
    ++pass.frames;
    if (progress) progress(pass.frames);
    if (pass.frames == max_frames) break;
  }
  constexpr int kMinFrames = 2;
  if (pass.frames < kMinFrames) return Error{ErrorCode::kIo, "fewer than two frames could be read"};
  driven.finish();
  const std::vector<RigidTransform> poses = driven.final_poses();
  pass.tracks = recorder.drive(poses);
  pass.turned_deg = turned_deg(poses);
  pass.mounting = straight_mounting(driven.results(), poses);
  for (const FrameResult& result : driven.results()) {
    pass.length_m += result.step_m;
    pass.ground_steps_m.push_back(result.accepted() ? *result.raw_over_online * result.online_step_m : 0.0);
  }
  if (auto slope = scale_slope(driven.results())) pass.slope = std::move(*slope);
  return pass;
}

std::optional<double> length_change(const std::vector<DrivePass>& a, const std::vector<DrivePass>& b) {
  std::vector<double> ratios;
  for (std::size_t d = 0; d < std::min(a.size(), b.size()); ++d) {
    const auto& before = a[d].ground_steps_m;
    const auto& after = b[d].ground_steps_m;
    for (std::size_t k = 0; k < std::min(before.size(), after.size()); ++k) {
      if (before[k] > 0.0 && after[k] > 0.0) ratios.push_back(after[k] / before[k]);
    }
  }
  if (ratios.size() < kLeastFrames) return std::nullopt;
  return median(std::move(ratios)) - 1.0;
}

}  // namespace groundscale
