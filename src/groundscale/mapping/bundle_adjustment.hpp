#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/geometry/rigid_transform.hpp"

namespace groundscale {

struct BundleView {
  RigidTransform cam_from_world;
  bool fixed = false;
};

/// That a view has seen a point, by their indices.
struct BundleObservation {
  int view = 0;
  int point = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

/// That two views lie so far apart, from elsewhere: what the ground says of a step.
struct BundleDistance {
  int view1 = 0;
  int view2 = 0;
  double distance = 1.0;
  double log_sd = 0.01;  ///< Of the log of the distance.
};

/// What is adjusted: the poses of the views that aren't fixed, and the points.
struct Bundle {
  CameraPtr camera;
  std::vector<BundleView> views;
  std::vector<Eigen::Vector3d> points_in_world;
  std::vector<BundleObservation> observations;
  std::vector<BundleDistance> distances = {};
};

enum class BundleLoss { kHuber, kCauchy };

template <>
std::vector<std::string_view> names_of<BundleLoss>();

struct BundleOptions {
  int max_iterations = 5;
  BundleLoss loss = BundleLoss::kHuber;
  double loss_px = 1.0;                 ///< Bound of the loss.
  double pixel_sd = 0.3;                ///< Of observations: what a distance is weighed against.
  double min_relative_decrease = 1e-4;  ///< Of the cost; the iteration ends below it.
};

void visit_fields(BundleOptions& options, FieldVisitor& visitor);

struct BundleSummary {
  int iterations = 0;           ///< Steps tried, those that were refused among them.
  int observations = 0;         ///< That took part.
  int shortened_steps = 0;      ///< Of points, to keep them in the field of their cameras, see adjust_bundle.
  double initial_rms_px = 0.0;  ///< sqrt(mean |pixel - project(R X + t)|^2) of the observations that took part.
  double final_rms_px = 0.0;
};

/// Poses and points that minimise
///   sum rho(|pixel - project(R_view X_point + t_view)|) + sum (pixel_sd log(|c_1 - c_2| / distance) / log_sd)^2 / 2,
/// c the centres of the views, by Levenberg-Marquardt, the points eliminated first (Triggs et al. 1999). Fixed views don't move. One fixed view leaves the scale free: it stays
/// near that of the start, for nothing but the damping holds it; two or more with a baseline fix it.
///
/// Left out are observations whose point doesn't project at the start, and those of a point with fewer than two.
/// A point that a step would take out of the field of a camera that sees it (behind a pinhole) goes only so far that it
/// stays inside, while the others make the whole step; a step of the poses that takes a point out by itself is refused.
/// @return kTooFewMatches where nothing is left to adjust, kNotConverged where the solver gives up; the bundle then is
///         as it was. Deterministic: the same input gives the same bytes. O(iterations * (observations +
///         sum over points of (free views that see it)^2 + free views^3)).
Result<BundleSummary> adjust_bundle(Bundle& bundle, const BundleOptions& options);

}  // namespace groundscale
