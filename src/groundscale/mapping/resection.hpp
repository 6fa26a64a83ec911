#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/estimation/ransac.hpp"
#include "groundscale/geometry/rigid_transform.hpp"

namespace groundscale {

/// A known point and where it is seen.
struct PointSight {
  Eigen::Vector3d point_in_world = Eigen::Vector3d::Zero();
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double sd_px = 1.0;  ///< > 0; beside that of the other points: its error is divided by it wherever errors count.
};

struct ResectionOptions {
  double loss_px = 1.0;       ///< Cauchy bound, for sd_px = 1.
  double max_error_px = 2.5;  ///< Of an inlier, for sd_px = 1.
  int max_iterations = 10;
  int min_inliers = 20;
  RansacOptions ransac;
};

void visit_fields(ResectionOptions& options, FieldVisitor& visitor);

struct Resection {
  RigidTransform cam_from_world;
  std::vector<int> inliers;  ///< Indices of the sights, ascending.
  double rms_px = 0.0;       ///< sqrt(mean |pixel - project(R X + t)|^2) of the inliers.
  /// Of the perturbation (w, u): R <- exp(w) R, t <- t + u; scaled by the inliers' own scatter.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

/// Pose that minimises sum rho(|pixel - project(R X + t)| / sd_px), rho = Cauchy, from a predicted one, by
/// Levenberg-Marquardt. The bound of the loss begins at twice the median error and is lowered with it down to loss_px.
/// Meant for a prediction that is off by some 10 px and up to 30 % wrong sights, even if those agree with the
/// prediction.
/// @return kTooFewMatches for fewer inliers than min_inliers, kNotConverged where the points don't fix a pose (all on
/// one
///         line). Deterministic. O(iterations * sights).
Result<Resection> refine_pose(const std::vector<PointSight>& sights, const Camera& camera,
                              const RigidTransform& cam_from_world_guess, const ResectionOptions& options);

/// The same without a prediction: RANSAC over triples (Kneip, Scaramuzza, Siegwart 2011), then refine_pose.
/// @return Errors as those of refine_pose. Deterministic for a given rng. O(trials * sights).
Result<Resection> resect(const std::vector<PointSight>& sights, const Camera& camera, const ResectionOptions& options,
                         Rng& rng);

}  // namespace groundscale
