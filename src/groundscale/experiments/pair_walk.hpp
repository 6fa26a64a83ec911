#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/rendered_drive.hpp"
#include "groundscale/experiments/source_drive.hpp"
#include "groundscale/geometry/trajectory.hpp"
#include "groundscale/io/road_masks.hpp"
#include "groundscale/odometry/options.hpp"
#include "groundscale/odometry/pair_observations.hpp"
#include "groundscale/odometry/views.hpp"
#include "groundscale/plane/observations.hpp"
#include "groundscale/tracking/tracker.hpp"

namespace groundscale {

/// Seconds of CPU that this thread has taken: what others do on the machine doesn't count.
double thread_cpu_s();

struct PairWalkOptions {
  OdometryOptions odometry;
  bool true_motion = false;  ///< R and t of the truth instead of those of the matches.
};

/// CPU time of what comes before any method.
struct PairTimes {
  double tracking_s = 0.0;  ///< Points followed from the frame before to this one.
  double motion_s = 0.0;    ///< Choice of the earlier frame; R and t.
  double road_s = 0.0;      ///< Of the latest `observe`: road points detected and matched, in two passes.
};

/// Walks through a drive whose truth is known as the pairwise odometry does, pair by pair, without its filters: what is
/// expected of a pair is the truth of the step before (constant speed) and the mean normal. So every method, and the
/// road in any region, can be looked at with the same pairs.
///
/// Deterministic. Holds the drive's latest frames.
class PairWalk {
 public:
  /// @return kBadInput: drive, camera or truth can't be read.
  static Result<PairWalk> open(const RenderedDrive& drive, const PairWalkOptions& options);

  /// On to the next frame that moved against an earlier one; false at the drive's end.
  bool next();

  int frame() const { return frame_.index; }
  double true_step() const { return true_motion_.translation.norm(); }  ///< Metres between the pair's views.
  double camera_height_m() const { return *drive_.setup.height_m; }
  const CameraPtr& camera() const { return drive_.setup.camera; }
  /// Where the road is in the earlier view, by the simulator; empty where the drive has no masks.
  const Image& road_mask() const { return pair_.view->road_mask; }
  const ExpectedRoad& expected() const { return expected_; }

  /// The region of the earlier view that the pairwise odometry would look in, or of other options.
  Image region(const RegionOptions& options) const;
  /// Observations of a region, as the pairwise odometry makes them: points detected, warped, tracked, a plane fitted
  /// with `sparse`, warped and tracked again.
  /// @param options  Of the region: points beside the path count less where it is no polygon.
  RoadObservations observe(const Image& region, const RegionOptions& options);
  const PairTimes& times() const { return times_; }

 private:
  PairWalk(SourceDrive drive, Trajectory truth, const Eigen::Vector3d& mean_normal, const PairWalkOptions& options);

  DrivenPath path_of(const RoadWarp& warp) const;
  void expect();
  void remember();

  SourceDrive drive_;
  Trajectory truth_;
  std::optional<RoadMasks> masks_;
  PairWalkOptions options_;
  Mounting mounting_;
  Eigen::Vector3d mean_normal_;
  Tracker tracker_;
  Views views_;
  Rng rng_;

  Frame frame_;
  Pair pair_;
  RigidTransform true_motion_;  ///< Of the pair, in metres.
  ExpectedRoad expected_;
  PairTimes times_;
  bool frame_is_kept_ = true;  ///< Whether the present frame is among the views, or has to be.
};

}  // namespace groundscale
