#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/estimation/ransac.hpp"
#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/tracking/matches.hpp"

namespace groundscale {

/// The same point seen along two rays, unit vectors.
struct RayPair {
  TrackId id = 0;
  Eigen::Vector3d ray1 = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d ray2 = Eigen::Vector3d::UnitZ();
};

/// Rays of matches; those outside the camera's valid field are left out.
std::vector<RayPair> ray_pairs(const Matches& matches, const Camera& camera);

struct MotionOptions {
  double max_error_px = 0.5;  ///< Epipolar error of an inlier.
  double loss_px = 0.25;      ///< Cauchy bound of the refinement.
  int min_inliers = 30;
  double still_px = 0.15;        ///< No motion at all where three quarters of the points move less.
  double min_parallax_px = 0.5;  ///< Pure rotation where three quarters of the points have less left beside a rotation.
  RansacOptions ransac;
};

void visit_fields(MotionOptions& options, FieldVisitor& visitor);

enum class MotionState { kMoving, kStill, kRotating, kLost };

/// How a camera moved between two views, as far as matches tell.
struct TwoViewMotion {
  MotionState state = MotionState::kLost;
  RigidTransform cam2_from_cam1;  ///< |t| = 1 when moving; t = 0 when rotating; identity when still.
  /// Of (rotation vector on the left of R, two tangents of t), rad^2; moving only.
  Eigen::Matrix<double, 5, 5> covariance = Eigen::Matrix<double, 5, 5>::Zero();
  std::vector<int> inliers;  ///< Indices of the pairs, ascending.
  double parallax_px = 0.0;  ///< Upper quartile of what no rotation explains.
  double rms_px = 0.0;       ///< Of the inliers' epipolar error.
  std::string reason;        ///< Why the motion is lost.
};

/// Rotation that explains the pairs best, robustly, and how much it leaves over.
struct RotationFit {
  Eigen::Matrix3d cam2_from_cam1 = Eigen::Matrix3d::Identity();
  double parallax_px = 0.0;  ///< Upper quartile of the angle left, times the focal length.
};
RotationFit fit_rotation(const std::vector<RayPair>& pairs, double focal_px);

/// Whether a share of the points has moved less than `still_px`; false without points.
bool has_stood_still(const std::vector<RayPair>& pairs, double focal_px, const MotionOptions& options,
                     double share = 0.75);
/// The share for a camera that stood before: a car that passes takes many points along.
inline constexpr double kShareAtHalt = 0.5;

/// R and t (|t| = 1) between two views: five-point RANSAC (Nister 2004) on unit rays, then all inliers by Sampson's
/// error with a Cauchy loss. Standing still and pure rotation are told apart first; no direction is invented for them.
/// @param focal_px  Turns the thresholds in pixels into angles.
/// @param guess     A motion to try before any sample, such as that of the pair before.
/// Deterministic for a given rng. O(trials * pairs).
TwoViewMotion estimate_motion(const std::vector<RayPair>& pairs, double focal_px, const MotionOptions& options,
                              Rng& rng, const std::optional<RigidTransform>& guess = std::nullopt);

}  // namespace groundscale
