#pragma once

#include <vector>

#include "groundscale/core/options.hpp"
#include "groundscale/estimation/kalman.hpp"

namespace groundscale {

struct MapScaleFilterOptions {
  double walk = 0.002;        ///< Random walk of log scale, a root metre.
  double drift_sd = 0.001;    ///< Of the drift, the scale's slope, about zero: a metre.
  double drift_length_m = 40; ///< Over which the drift forgets itself.
  double start_sd = 0.05;     ///< Of log scale at the start.
};

void visit_fields(MapScaleFilterOptions& options, FieldVisitor& visitor);

/// Metres per map unit as a slow process along the path, observed by the ground.
///
/// State: s = log(metres per unit) and its slope d by the distance x driven,
///   s(x + dx) = s + d dx + w,  d(x + dx) = exp(-dx / L) d + v,
/// var w = walk^2 dx, var v = drift_sd^2 (1 - exp(-2 dx / L)). Online as the drive goes, backwards
/// (Rauch-Tung-Striebel) at its end.
class MapScaleFilter {
 public:
  explicit MapScaleFilter(const MapScaleFilterOptions& options);

  /// Starts anew at a scale: a map has begun.
  void start(double log_scale, double sd);
  void predict(double distance_m);
  /// Observation of log scale. One that is off by more than 2.5 sd counts less, as in Huber's loss.
  void update(double log_scale, double sd);

  double log_scale() const { return state_.mean(0); }
  double sd() const;
  double drift_per_m() const { return state_.mean(1); }

  /// Closes a frame, so that `smoothed` can return to it.
  void keep();
  /// Log scale of every kept frame given the whole drive, with its sd.
  struct Smoothed {
    double log_scale = 0.0;
    double sd = 0.0;
  };
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
