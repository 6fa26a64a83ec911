#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "groundscale/camera/mounting.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/geometry/ground_plane.hpp"

namespace groundscale {

enum class FilterKind {
  kPaper,
  kModel,
  kPaperScale,  ///< The paper's for methods that have no normal of their own: observes the height alone.
};

struct GroundFilterOptions {
  FilterKind kind = FilterKind::kModel;
  double acceleration_mps2 = 2.0;        ///< Sd of the change of speed, a second.
  double mean_drift_deg = 0.03;          ///< Random walk of mean pitch and roll, a root second.
  double deviation_deg = 0.8;            ///< Sd of pitch and roll about their mean: suspension and slope.
  double deviation_time_s = 0.5;         ///< Correlation time of the deviation.
  double formal_variance_factor = 20.0;  ///< The formal covariance is that much too small (design, measured).
  double angle_model_deg = 0.3;          ///< Roads aren't planes: added to pitch and roll,
  double step_model = 0.02;              ///< and to log step.
};

void visit_fields(GroundFilterOptions& options, FieldVisitor& visitor);

/// What one pair of views said about the ground, ready for the filter.
struct GroundObservation {
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
  double log_distance = 0.0;  ///< Log of the pair's baseline in metres.
  /// Of the three, from the formal covariance of m.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// Metres of the pair's baseline that lie before the present step: 0 where the partner is the frame before.
  double lead_m = 0.0;
  double step_time_s = 0.1;  ///< From the frame before to this one.
};

/// Turns a plane in units of the pair's baseline into an observation: with m = n / h, the baseline in metres is
/// camera_height_m |m|.
GroundObservation observation_of(const GroundPlane& plane, const Eigen::Matrix3d& covariance_of_m,
                                 double camera_height_m);

/// What is known of the ground and the speed in a frame.
struct GroundState {
  double pitch_rad = 0.0, roll_rad = 0.0;            ///< Of the road now.
  double mean_pitch_rad = 0.0, mean_roll_rad = 0.0;  ///< Of the mounting.
  double speed_mps = 0.0;
  double log_speed_sd = 0.0;

  /// Of the road now, a unit vector.
  Eigen::Vector3d normal_in_cam() const { return Mounting{pitch_rad, roll_rad, 0.0}.normal_in_cam(); }
};

/// How the vehicle went on since the frame before.
struct GroundStep {
  double dt_s = 0.1;
  double pitch_change_rad = 0.0;  ///< Of the road in the camera, by the camera's own rotation.
  double roll_change_rad = 0.0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< cam_from_previous_cam.
  Eigen::Vector3d direction = Eigen::Vector3d(0, 0, -1);   ///< Unit translation of cam_from_previous_cam.
  /// Log of present over last speed from the tracked points' structure, with its sd, where it is known.
  std::optional<double> log_speed_change = std::nullopt;
  double log_speed_change_sd = 0.02;
};

/// Kalman filter of ground and speed: online as the drive goes, and backwards (Rauch-Tung-Striebel) at its end.
class GroundFilter {
 public:
  virtual ~GroundFilter() = default;

  /// Starts, or starts anew, with the first accepted observation.
  virtual void start(const GroundObservation& observation) = 0;
  /// One frame on. Before `start` nothing happens.
  virtual void predict(const GroundStep& step) = 0;
  /// One frame on in which the vehicle stood.
  virtual void stand(double dt_s) = 0;
  virtual void update(const GroundObservation& observation) = 0;
  /// The speed in the present step alone, > 0, from elsewhere than the ground. Before `start` nothing happens.
  /// @param log_sd  Sd of its log, > 0.
  virtual void update_speed(double speed_mps, double log_sd) = 0;
  /// Trusts itself less, after it has refused too much.
  virtual void reopen() = 0;
  virtual bool started() const = 0;
  virtual GroundState state() const = 0;

  /// Closes a frame, so that `smoothed` can return to it. @return its number, counted from 0.
  virtual int keep() = 0;
  /// States of all kept frames given the whole drive.
  virtual std::vector<GroundState> smoothed() const = 0;
};

std::unique_ptr<GroundFilter> make_ground_filter(const GroundFilterOptions& options, double camera_height_m);

}  // namespace groundscale
