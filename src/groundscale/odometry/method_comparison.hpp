#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "groundscale/odometry/odometry.hpp"
#include "groundscale/odometry/pair_chain.hpp"
#include "groundscale/odometry/pairwise.hpp"

namespace groundscale {

/// What one of several methods has made of a drive.
class ComparedMethod final : public DriveOutcome {
 public:
  ComparedMethod(const PlaneMethod& method, const CameraSetup& setup, const OdometryOptions& options);

  std::string_view name() const { return name_; }
  const std::vector<FrameResult>& results() const override { return chain_.results(); }
  bool scaled() const override { return chain_.scaled(); }
  const std::vector<RigidTransform>& online_poses() const override { return chain_.online_poses(); }
  std::vector<RigidTransform> final_poses() const override { return chain_.final_poses(); }
  Mounting mounting() const override { return chain_.mounting().mounting(); }
  /// Time of the method itself a frame, without matching, motion, gates and filter; as long as the results, 0 where
  /// there was no road to measure.
  const std::vector<double>& time_ms() const { return time_ms_; }

  /// The next frame, as another odometry has seen it.
  void follow(const PairwiseOdometry& front);
  void finish() { chain_.finish(); }

 private:
  Result<RoadMeasurement> measure(const PairwiseOdometry& front, double expected_distance_m, FrameResult& result);

  std::string name_;
  EstimatePlane estimate_;
  Rng rng_;
  PairChain chain_;
  std::vector<double> time_ms_;
};

/// Several ways to measure the ground on the same drive: one odometry matches the images, finds the motions and, by the
/// method that the options name, where the road is expected; each method is handed the same matches, motion and
/// mounting, and has gates, filter and chain of its own.
///
/// What a method starts from where it looks nearby (RoadObservations::predicted_plane) is its own filter's prediction,
/// or that of the odometry where the method has no scale yet or has lost its hold (PairChain::needs_search): as a
/// program on its own searches anew then, none stays lost because of where it has once been. Deterministic but for the
/// times.
class MethodComparison {
 public:
  /// @param methods  Rows of `ground_methods` or the caller's own.
  /// @return As PairwiseOdometry::create.
  static Result<MethodComparison> create(const CameraSetup& setup, const OdometryOptions& options,
                                         const std::vector<PlaneMethod>& methods);

  void advance(const Frame& frame, const Image& road_mask);
  /// After the last frame: steps from the whole drive.
  void finish();

  const std::vector<ComparedMethod>& methods() const { return methods_; }
  const PairwiseOdometry& front() const { return front_; }

 private:
  MethodComparison(PairwiseOdometry front, std::vector<ComparedMethod> methods)
      : front_(std::move(front)), methods_(std::move(methods)) {}

  PairwiseOdometry front_;
  std::vector<ComparedMethod> methods_;
};

/// The methods of these names, in their order.
/// @return kBadInput: no names, an unknown one (those that are known are listed), one twice.
Result<std::vector<PlaneMethod>> choose_methods(const std::vector<std::string>& names);

/// `methods.csv` (docs/formats.md): a row a frame and method, frames ascending, methods in their order.
std::string methods_csv(const std::vector<ComparedMethod>& methods);

}  // namespace groundscale
