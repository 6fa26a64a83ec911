#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/core/options.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/geometry/ground_plane.hpp"

namespace groundscale {

struct PointPlaneOptions {
  double min_point_sd_m = 0.01;  ///< Roughness of a road: no point says more than this about the plane.
  double tie_sd_m = 0.01;        ///< Sd of the camera's height over the road, for each root metre driven.
  double pitch_prior_deg = 1.0;  ///< Sd of the normal's pitch about the expected one, where one is given,
  double roll_prior_deg = 0.5;   ///< and of its roll.
  /// Sd of the road's curvature along the path, up or down; 0: a plane.
  double curvature_sd_per_m = 0.004;
  int min_points = 15;
};

void visit_fields(PointPlaneOptions& options, FieldVisitor& visitor);

/// Road points of a map as one camera sees them, and that camera's own way, in any unit.
struct PlanePoints {
  std::vector<Eigen::Vector3d> points_in_cam;
  std::vector<double> weights;  ///< As long as points_in_cam, 0 to 1.
  /// Where the camera was before, most recent first: at the same height over the road as now.
  std::vector<Eigen::Vector3d> centres_in_cam;
  /// Where the normal is expected, a unit vector; zero where nothing is known.
  Eigen::Vector3d expected_normal = Eigen::Vector3d::Zero();
  /// Unit direction of the path along the road.
  Eigen::Vector3d forward_in_cam = Eigen::Vector3d::UnitZ();
  double metres_per_unit = 1.0;  ///< Of the points and centres, as far as known: the options are in metres.
};

/// The plane through road points.
struct PointPlane {
  GroundPlane plane;             ///< Tangent beneath the camera, its height in the points' unit.
  double curvature_per_m = 0.0;  ///< Of the road along the path, > 0 where it rises towards what lies ahead and behind.
  double log_height_sd = 0.0;    ///< Formal sd of log(height): of independent errors, which those of a road aren't.
  double rms_m = 0.0;            ///< Weighted, of the inliers about the road.
  std::vector<int> inliers;      ///< Indices of points within three robust sd of the road, ascending.
};

/// Road from points of a map: n.X + k a^2 / 2 = h, a = forward.X along the path, that minimises (in metres)
///   sum w_i rho((n.X_i + k a_i^2 / 2 - h) / s) + sum (n.c_j + k a_j^2 / 2)^2 / (2 tie^2 |c_j|) + priors,
/// rho = Cauchy's loss with bound 2, s = the points' own robust sd (1.4826 weighted median of the absolute residuals,
/// at least min_point_sd_m), priors: half the squares of pitch and roll about the expected normal and of k about 0,
/// each over its sd.
///
/// k: where a street meets another its slope changes within metres, and no plane through what lies behind and ahead has
/// the camera's height. Centres c_j: a camera on wheels drives parallel to its road, so its own way says what the
/// normal is where points lie on one line or to one side. Source: the plane of Zhou, Dai, Li 2019, from points of
/// a map in place of a homography; curvature and tie are ours.
/// @return kTooFewMatches for fewer than min_points; kNotGround where points, ties and priors leave pitch or roll open
///         (sd above 0.3 rad) or the points lie above the camera.
/// Eight Gauss-Newton steps with reweighting. Deterministic. O(n log n) in the points.
Result<PointPlane> fit_point_plane(const PlanePoints& points, const PointPlaneOptions& options);

}  // namespace groundscale
