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
#include "groundscale/plane/method_options.hpp"
#include "groundscale/plane/observations.hpp"

namespace groundscale {

enum class PlaneRefinement { kLevenbergMarquardt, kNelderMead };

/// Where `sparse` starts: at the plane of the road's homography, or at the predicted plane where there is one.
enum class PlaneStart { kHomography, kPredicted };

struct PlaneOptions {
  double max_epipolar_px = 0.7;  ///< Road points must agree with R, t this well.
  double max_error_px = 1.0;     ///< Symmetric transfer error of an inlier, each way.
  double huber_px = 0.5;         ///< Bound r0 of the Huber loss.
  /// Sd of the expected normal, where one is given; 0: not used. Pitch and height are strongly correlated, and in a
  /// turn few points tell them apart.
  double normal_prior_deg = 1.0;
  /// Sd of the angle between the plane and the driving direction, where one is given; 0: not used.
  double direction_prior_deg = 0.7;
  double point_sd_px = 0.9;  ///< What a point is worth against these priors, since roads aren't planes.
  int min_inliers = 30;
  PlaneRefinement refinement = PlaneRefinement::kLevenbergMarquardt;
  PlaneStart start = PlaneStart::kHomography;
  RansacOptions ransac{.min_trials = 20, .max_trials = 200, .confidence = 0.999};
  // Of single methods; what stands above is common to all that have such a thing.
  TriangulationPlaneOptions triangulation{};
  TriangulationRansacOptions triangulation_ransac{};
  DecompositionOptions decomposition{};
  DelaunayOptions delaunay{};
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
  /// Its normal is given or isn't worth filtering: the paper's filter observes the height alone (GroundFilterOptions).
  bool scale_alone = false;
};

/// `make` of a method that is a function of one frame.
template <Result<PlaneMeasurement> (*Estimate)(const RoadObservations&, const PlaneOptions&, Rng&)>
EstimatePlane make_memoryless(const PlaneOptions& options) {
  return [options](const RoadObservations& observations, Rng& rng) { return Estimate(observations, options, rng); };
}

/// The methods that need no pixels; `ground_methods` in road/ has all. Adding one is one row in this table.
std::span<const PlaneMethod> plane_methods();

/// The paper's method (Zhou, Dai, Li 2019, Algorithm 1, steps 2 to 4): homography by RANSAC on the points that agree
/// with the motion, linear start of m = n / h over all nine of its entries (PlaneStart: or the predicted plane), then m
/// alone by the symmetric transfer error
///   sum rho(|x2 - H x1|) + rho(|x1 - H^-1 x2|),  H = R + t m^T,  rho = Huber,
/// in pixels through the camera model, and the priors of n. Every further view adds the same terms for the same m.
/// @return kTooFewMatches, kDegenerateMotion (view 1 has no baseline), kNotGround (the homography is no plane's).
/// Deterministic for a given rng. O(trials * points + iterations * sights).
Result<PlaneMeasurement> estimate_plane_sparse(const RoadObservations& observations, const PlaneOptions& options,
                                               Rng& rng);

/// The height that most points vote for, the normal being known (Geiger, Ziegler, Stiller 2011, StereoScan; libviso2's
/// monocular odometry). Points are triangulated from R and t of view 1; of those nearer than the median of
/// |X| + |Y| + |Z| the heights h_i = n.X_i are scored by
///   q_i = sum_j exp(-(h_i - h_j)^2 / (2 sigma^2)),  sigma = median / mu,
/// and the one with the best score is the camera's. n is the expected normal: an error of its pitch goes into the
/// height with the lever at which the points lie. Points count with their weight, those of the scene 1.
///
/// Covariance: of the height from the peak of the score for the normal as given, of the normal from normal_prior_deg
/// (none where that is 0); R and t count as exact. Two views; rng isn't used.
/// @return kBadInput (no expected normal), kTooFewMatches, kDegenerateMotion, kNotGround (no point lies low enough).
/// O(n^2) in the points at worst, mostly O(n log n).
Result<PlaneMeasurement> estimate_plane_triangulation(const RoadObservations& observations, const PlaneOptions& options,
                                                      Rng& rng);

/// The plane through most triangulated points: RANSAC over three of them, then least squares of all within
/// max_distance h (Graeter, Schwarze, Lauer 2015). Where vanishing_point_sd_deg is above 0, the direction of motion
/// c = -R^T t / |t|, in which the lines of a straight road vanish, is fused with the normal by their variances: c.n =
/// 0.
///
/// Covariance: of the distances to the plane; R and t count as exact. Two views.
/// @return kTooFewMatches, kDegenerateMotion, kNotGround (no plane near the expected one, points on one line).
Result<PlaneMeasurement> estimate_plane_triangulation_ransac(const RoadObservations& observations,
                                                             const PlaneOptions& options, Rng& rng);

/// The plane from the road's homography alone: RANSAC and all inliers as in `sparse`, then decomposed into R, t / h and
/// n; of the four solutions the one in front of which the points lie and which is nearest to the expected normal and
/// to the given motion. The height is 1 / |t / h| of the decomposition in units of the given |t|; its own R and t are
/// `motion`.
///
/// Covariance: that of the eight numbers of a homography. Two views.
/// @return kTooFewMatches, kDegenerateMotion, kNotGround (no solution near what is known, points on one line).
Result<PlaneMeasurement> estimate_plane_decomposition(const RoadObservations& observations, const PlaneOptions& options,
                                                      Rng& rng);

/// R, t (|t| kept) and m together by the symmetric transfer error of the road points, from the given motion and the
/// linear start of `sparse` (Zhou, Dai, Li 2019, eq. 5, which the paper argues against): the same cost, its loss and
/// its prior of the normal, with five more unknowns. Always by Levenberg and Marquardt. `motion` holds R and t.
///
/// Covariance: R and t as free as m. Two views.
/// @return as estimate_plane_sparse, and kNotGround where the points leave the eight numbers open.
Result<PlaneMeasurement> estimate_plane_joint(const RoadObservations& observations, const PlaneOptions& options,
                                              Rng& rng);

/// Ground points by Delaunay triangulation of all points in the image (Wang, Zhang, Yin, Du, Chen 2018, Monocular
/// Visual Odometry Scale Recovery Using Geometrical Constraint). Vertices that break the order of row and depth with
/// their neighbours are dropped; triangles are kept whose normal fits the expected one and that lie low; the height is
/// the mode of their corners' heights over a window of frames. Heights of different frames are brought to one unit by
/// predicted_plane; without it the window is this frame.
///
/// Covariance: of the height from the mode, of the normal from the fit or from normal_prior_deg. Two views.
/// @return kBadInput (no expected normal), kTooFewMatches, kDegenerateMotion, kNotGround. Remembers heights of earlier
///         frames. O(n log n) for the triangulation, O(n^2) for the mode at worst.
EstimatePlane make_delaunay_method(const PlaneOptions& options);

}  // namespace groundscale
