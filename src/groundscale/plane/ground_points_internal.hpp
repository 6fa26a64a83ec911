#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "groundscale/geometry/ground_plane.hpp"
#include "groundscale/plane/methods.hpp"

namespace groundscale {

/// A point triangulated from the reference view and view 1.
struct GroundPoint {
  Eigen::Vector3d point_in_cam = Eigen::Vector3d::Zero();  ///< In the reference view, in the unit of the translations.
  Eigen::Vector2d pixel_in_reference = Eigen::Vector2d::Zero();
  double weight = 1.0;
};

/// Points in front of both cameras, each on its ray in the reference view where the ray of view 1 passes nearest. Road
/// points must agree with the motion within max_epipolar_px; points of the scene count 1.
std::vector<GroundPoint> triangulate_ground_points(const RoadObservations& observations, const PlaneOptions& options,
                                                   GroundPoints which);

/// Where heights lie closest together.
struct HeightMode {
  double height = 0.0;
  double variance = 0.0;  ///< Formal, of independent heights.
  int supporters = 0;     ///< Heights within two sigma.
};

/// The height with the largest score q_i = sum_j w_j exp(-(h_i - h_j)^2 / (2 sigma^2)) (Geiger, Ziegler, Stiller 2011).
///
/// Variance: the mode is an M-estimate with psi(r) = r exp(-r^2 / (2 sigma^2)), so sum w^2 psi^2 / (sum w psi')^2.
/// @param heights, weights  Equally many, at least one.
HeightMode mode_of_heights(std::span<const double> heights, std::span<const double> weights, double sigma);

/// Of (two tangents of n, h) where n was fitted to the points and h is the mode of n.X: what the heights leave open,
/// and what isn't known of the normal, which moves the height with the lever at which the voters lie.
Eigen::Matrix3d covariance_of_vote(const std::vector<GroundPoint>& points, const Eigen::Vector3d& normal,
                                   const HeightMode& mode, double sigma, const Eigen::Matrix2d& normal_covariance);

/// A plane n.X = h through points, and how uncertain (two tangents of n, h) are: n + T (a, b), T = tangents_of(n).
struct PlaneFit {
  GroundPlane plane;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// Least squares of the distances to the plane, weighted; normal on the side of the points.
/// @return kNotGround where the points lie on one line.
Result<PlaneFit> fit_plane(const std::vector<GroundPoint>& points);

/// Covariance of m = n / h from that of (two tangents of n, h).
Eigen::Matrix3d covariance_of_m(const GroundPlane& plane, const Eigen::Matrix3d& covariance);

/// Of (two tangents of n, h) where n was taken as given: the height's from the mode, for that normal; the normal's from
/// normal_prior_deg, as much smaller as image noise of `rms_px` is smaller than point_sd_px, so that it is as formal as
/// the other. What an error of the normal does to the height isn't in it.
Eigen::Matrix3d covariance_given_normal(const RoadObservations& observations, const PlaneOptions& options,
                                        double rms_px, const HeightMode& mode);

}  // namespace groundscale
