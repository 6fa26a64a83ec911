#pragma once

#include <vector>

#include "groundscale/core/options.hpp"
#include "groundscale/estimation/kalman.hpp"

namespace groundscale {

struct MapScaleFilterOptions {
  double walk = 0.002;             ///< Random walk of log scale, for each root metre,
  double turn_walk = 0.03;         ///< and for each root radian of turning.
  double turn_drift_sd = 0.1;      ///< Prior sd of the drift per radian of turning: what a wrong calibration does.
  double turn_drift_walk = 0.002;  ///< Random walk of that drift, for each root metre.
  double start_sd = 0.1;           ///< Sd of log scale at a map's start.
};

void visit_fields(MapScaleFilterOptions& options, FieldVisitor& visitor);

/// Metres per map unit as a slow process along the path, observed by the ground.
///
/// State: s = log(metres per unit), and b, its drift per radian that the camera turns by, left or right: a camera whose
/// radial distortion isn't what its calibration says loses scale in turns, always to the same side. Over dx metres and
/// an angle da
///   s += b |da| + w,  b += v,  var w = walk^2 dx + turn_walk^2 |da|,  var v = turn_drift_walk^2 dx;
/// z = s + e is observed, var e given with each z. A Kalman filter as the drive goes, backwards (Rauch, Tung, Striebel
/// 1965) at its end. Deterministic; O(1) a frame.
class MapScaleFilter {
 public:
  explicit MapScaleFilter(const MapScaleFilterOptions& options);

  /// Starts anew at a scale, sd of its log: a map has begun. The drift in turns is the camera's and goes on.
  void start(double log_scale, double sd);
  /// The map's unit is another one from here on: s += log_ratio, as certain as before.
  void change_unit(double log_ratio);
  /// @param distance_m  Driven since the last call, >= 0.
  /// @param turn_rad    Turned by since then; its sign makes no difference.
  void predict(double distance_m, double turn_rad);
  /// Observation, with its sd > 0, of log scale as it was before the camera turned by the last `turned_rad`: points
  /// carry the scale of when they were seen. One that is off by more than 2.5 sd (of both together) counts less, as
  /// in Huber's loss.
  void update(double log_scale, double sd, double turned_rad = 0.0);

  double log_scale() const { return state_.mean(0); }
  double sd() const;
  double drift_per_rad() const { return state_.mean(1); }
  double drift_per_rad_sd() const;

  /// Closes a frame, so that `smoothed` can return to it.
  void keep();
  /// The latest frames are of this state too: a start that reaches back. @pre so many were kept.
  void keep_again(int frames);
  /// Log scale of a frame given the whole drive, with its sd.
  struct Smoothed {
    double log_scale = 0.0;
    double sd = 0.0;
  };
  /// One for each `keep`, in their order; nothing is carried backwards over a start. O(frames).
  std::vector<Smoothed> smoothed() const;

 private:
  using State = Gaussian<2>;
  struct Kept {
    Eigen::Matrix2d transition;  ///< From the frame before.
    State predicted, filtered;
    bool started;  ///< Nothing goes over from the frame before.
  };

  MapScaleFilterOptions options_;
  State state_, predicted_;
  Eigen::Matrix2d transition_ = Eigen::Matrix2d::Identity();
  bool started_ = true;
  std::vector<Kept> kept_;
};

}  // namespace groundscale
