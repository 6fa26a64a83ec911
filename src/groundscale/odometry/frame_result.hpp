#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "groundscale/geometry/rigid_transform.hpp"

namespace groundscale {

/// What a vehicle did in a frame, as far as the images tell.
enum class FrameState {
  kMoving,
  kStill,
  kRotating,  ///< Turned without moving.
  kBridged,   ///< No motion found; pose by constant velocity.
  kLost,      ///< The same for longer than a bridge may be: straight on, at constant speed.
};
std::string_view name_of(FrameState state);

/// Reason of a frame that has not moved since the one before.
inline constexpr std::string_view kStandingStill = "standing still";

/// One frame of a drive. Poses have no scale of their own: a link to an earlier frame, and the length of the step to
/// the frame before; metres are made at output, so a correction of scale is one number a frame.
struct FrameResult {
  int frame = 0;  ///< In the source.
  double time_s = 0.0;
  FrameState state = FrameState::kLost;
  std::string reason;         ///< Why there is no accepted measurement; empty where there is one.
  bool by_speed_log = false;  ///< No accepted measurement, and a speed log has moved the scale in its place.

  int reference = -1;  ///< Index of the result that the pose is linked to; -1 for the first.
  Eigen::Matrix3d reference_from_cam = Eigen::Matrix3d::Identity();
  Eigen::Vector3d direction_in_reference = Eigen::Vector3d::Zero();  ///< Unit; zero where the camera stood.

  double online_step_m = 0.0;  ///< Distance to the frame before; valid once `scaled`.
  double step_m = 0.0;         ///< The same from the whole drive, once finished.
  bool scaled = false;
  double online_step_sd = 0.0;  ///< Of log step, filtered.
  double step_sd = 0.0;         ///< Of log step, smoothed.
  double shape_sd = 0.0;        ///< The part of both that turns, crests and dips add.

  /// This frame's own measurement over the online step of its pair; empty where none was made.
  std::optional<double> raw_over_online;
  double raw_sd = 0.0;  ///< Of the log of the measurement.
  std::optional<double> pitch_rad, roll_rad;
  std::optional<double> map_scale;    ///< Metres per unit of the map in force; keyframe mode.
  std::optional<double> drift_ratio;  ///< lambda, this frame's measured scale of the map over the one in force.
  int tracks = 0;                     ///< In this frame; of them
  int tracks_kept = 0;                ///< followed from the frame before.
  int matches = 0;                    ///< With the partner,
  int inliers = 0;                    ///< and those that fit the motion,
  double rms_px = 0.0;                ///< by their epipolar error.
  int road_matches = 0;               ///< The same for the road and its plane, by their transfer error.
  int road_inliers = 0;
  double road_rms_px = 0.0;  ///< 0 also where the plane is the map's and none of its points was followed here.

  bool accepted() const { return raw_over_online.has_value() && reason.empty(); }
};

/// That a local map was scaled by lambda because its scale had drifted.
struct ScaleEvent {
  int frame = 0;                      ///< Its number in the source.
  double lambda = 1.0;                ///< What the map was scaled by.
  double drift_before = 1.0;          ///< Drift ratio of the last measurement before,
  std::optional<double> drift_after;  ///< and of the first one after; empty where none came.
};

/// That numbers of the camera were found anew while driving.
struct CameraEvent {
  int frame = 0;  ///< Its number in the source.
  struct Value {
    double value = 0.0;
    double sd = 0.0;
  };
  std::map<std::string, Value> values;  ///< By the name in a camera file.
};

}  // namespace groundscale
