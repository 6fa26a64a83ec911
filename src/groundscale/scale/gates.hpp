#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "groundscale/core/options.hpp"
#include "groundscale/geometry/ground_plane.hpp"
#include "groundscale/scale/ground_filter.hpp"

namespace groundscale {

struct GateOptions {
  double mounting_deg = 5.0;             ///< Initial and refined normal against the mounting normal.
  double unsettled_mounting_deg = 12.0;  ///< The same until the mounting has been found.
  double mean_deg = 2.5;                 ///< Refined normal against the running mean of accepted ones.
  double min_depth_ratio = 1.3;          ///< Depth of the farthest over the nearest inliers (95 and 5 %).
  double min_width_m = 0.5;              ///< Spread of the inliers across the path (5 to 95 %).
  double min_speed_mps = 0.5;
  double max_acceleration_mps2 = 6.0;  ///< What a road vehicle can do.
  double max_step_sd = 0.1;            ///< Formal sd of log step, enlarged as the filter does.
};

void visit_fields(GateOptions& options, FieldVisitor& visitor);

/// What is expected of a measurement.
struct GateContext {
  Eigen::Vector3d mounting_normal = Eigen::Vector3d::UnitY();
  bool mounting_settled = false;
  bool filter_started = false;
  Eigen::Vector3d mean_normal = Eigen::Vector3d::UnitY();  ///< Of accepted measurements.
  double expected_distance_m = 0.0;
  double expected_log_sd = 0.0;  ///< Of the distance.
  double step_time_s = 0.1;
  double pair_time_s = 0.1;
};

/// What was measured.
struct GateCandidate {
  GroundPlane initial_plane, plane;  ///< In baselines.
  std::vector<Eigen::Vector3d> inlier_rays;
  double distance_m = 0.0;
  double log_sd = 0.0;
};

/// Why a measurement is refused; empty where it passes.
std::string refusal(const GateCandidate& candidate, const GateContext& context, const GateOptions& options);

}  // namespace groundscale
