#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "groundscale/core/options.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/estimation/ransac.hpp"
#include "groundscale/geometry/ground_plane.hpp"
#include "groundscale/plane/dense_options.hpp"
#include "groundscale/plane/observations.hpp"

namespace groundscale {

enum class PlaneRefinement { kLevenbergMarquardt, kNelderMead };

struct PlaneOptions {
  double max_epipolar_px = 0.7;  ///< Road points must agree with R, t this well.
  double max_error_px = 1.0;     ///< Symmetric transfer error of an inlier, each way.
  double huber_px = 0.5;         ///< Bound r0 of the Huber loss.
  /// Sd of the expected normal, where one is given; 0: not used. Pitch and height are strongly correlated, and in a
  /// turn few points tell them apart.
  double normal_prior_deg = 1.0;
  double point_sd_px = 0.9;  ///< What a point is worth against the prior, since roads aren't planes.
  int min_inliers = 30;
  PlaneRefinement refinement = PlaneRefinement::kLevenbergMarquardt;
  RansacOptions ransac{.min_trials = 20, .max_trials = 200, .confidence = 0.999};
  DenseOptions dense{};
  FixedPlaneOptions fixed_plane{};
  FusedOptions fused{};
};

void visit_fields(PlaneOptions& options, FieldVisitor& visitor);

/// The plane of the road in the reference view, as one method measured it.
struct PlaneMeasurement {
  GroundPlane plane;          ///< In the unit of the views' translations.
  GroundPlane initial_plane;  ///< Where the refinement started.
  /// Formal covariance of m = n / h: image noise and, where given, the uncertainty of R and t. Roads aren't planes: the
  /// truth is five to ten times as large, see GroundFilter's model term.
  Eigen::Matrix3d covariance_of_m = Eigen::Matrix3d::Zero();
  std::vector<int> inliers;  ///< Indices of the points that lie on the plane, ascending.
  double rms_px = 0.0;       ///< Transfer error of the inliers, one way.
  /// cam2_from_cam1 with |t| = 1 from the road alone, of methods that don't take it as given.
  std::optional<RigidTransform> motion{};
};

/// Measures the plane in a pair of views, or more. One object a drive, handed its frames in their order: a method may
/// remember what it saw.
using EstimatePlane = std::function<Result<PlaneMeasurement>(const RoadObservations& observations, Rng& rng)>;

/// A way to measure the plane, under the name that `ground.method` knows it by.
struct PlaneMethod {
  std::string_view name;
  std::string_view summary;
  EstimatePlane (*make)(const PlaneOptions& options);
};

/// `make` of a method that is a function of one frame.
template <Result<PlaneMeasurement> (*estimate)(const RoadObservations&, const PlaneOptions&, Rng&)>
EstimatePlane make_memoryless(const PlaneOptions& options) {
  return [options](const RoadObservations& observations, Rng& rng) { return estimate(observations, options, rng); };
}

/// The methods that need no pixels; `ground_methods` in road/ has all. Adding one is one row in this table.
std::span<const PlaneMethod> plane_methods();

/// The paper's method (Zhou, Dai, Li 2019, Algorithm 1, steps 2 to 4): homography by RANSAC on the points that agree
/// with the motion, linear start of m = n / h over all nine of its entries, then m alone by the symmetric transfer
/// error
///   sum rho(|x2 - H x1|) + rho(|x1 - H^-1 x2|),  H = R + t m^T,  rho = Huber,
/// in pixels through the camera model. Every further view adds the same terms for the same m.
/// @return kTooFewMatches, kDegenerateMotion (view 1 has no baseline), kNotGround (the homography is no plane's).
/// Deterministic for a given rng. O(trials * points + iterations * sights).
Result<PlaneMeasurement> estimate_plane_sparse(const RoadObservations& observations, const PlaneOptions& options,
                                               Rng& rng);

}  // namespace groundscale
