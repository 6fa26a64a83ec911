#pragma once

#include <optional>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/geometry/trajectory.hpp"

namespace groundscale {

/// Mean errors over segments. Fractions and radians, not percent and degrees.
struct SegmentErrors {
  int segments = 0;
  double t_rel = 0.0;            ///< Mean of |error of the end point| / length.
  double r_rel_rad_per_m = 0.0;  ///< Mean of the angle between the ends / length.
};

struct KittiErrors {
  std::optional<SegmentErrors> all;  ///< Over all segments of all lengths; empty where the path is too short.
  struct OfLength {
    double length_m = 0.0;
    std::optional<SegmentErrors> errors;
  };
  std::vector<OfLength> by_length;  ///< In the order of the lengths asked for.
};

/// Lengths of the KITTI odometry benchmark, 100 m to 800 m.
std::vector<double> kitti_lengths_m();

/// Errors as KITTI's odometry devkit defines them: a segment starts at every 10th row and ends at the first row whose
/// distance along the truth is more than the length further; its error is E = est_end_from_start^-1
/// true_end_from_start, both relative to the segment's first row. Nothing is aligned, scale least of all.
/// @param lengths_m  Positive.
/// @return kBadInput as compare_steps, and for lengths that are not positive. O(n log n) a length. Geiger et al. 2012.
Result<KittiErrors> kitti_errors(const Trajectory& estimate, const Trajectory& truth,
                                 const std::vector<double>& lengths_m = kitti_lengths_m());

}  // namespace groundscale
