#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/core/result.hpp"

namespace groundscale {

/// One of the motions and planes that a homography may come from: H ~ R + t n^T with |n| = 1, t in units of the
/// distance to the plane in camera 1.
struct HomographyDecomposition {
  Eigen::Matrix3d rotation;     ///< cam2_from_cam1.
  Eigen::Vector3d translation;  ///< Over the height h.
  Eigen::Vector3d normal;
};

/// All decompositions of a Euclidean homography of rays, cam2_ray ~ H cam1_ray, of any scale: four, as (R, t, n) and
/// (R, -t, -n), of two motions. Both cameras are on the same side of the plane, hence det H > 0 with H of the sense
/// that maps rays in front onto rays in front.
///
/// Analytic (Malis, Vargas 2007, INRIA RR-6303): S = H^T H - I = n a^T + a n^T with a = R^T t + |t|^2 n / 2; the
/// opposite of its cofactors is w w^T with w = n x a, so that row i of S, plus or minus e_i x w, is parallel to n and
/// to a. Their square roots of three minors are the components of w; here all come from the largest, so that small
/// ones keep their digits.
/// @return kNotGround where H isn't finite or det H <= 0, kDegenerateMotion where it is a rotation (no plane, or no
///         motion).
Result<std::vector<HomographyDecomposition>> decompose_homography(const Eigen::Matrix3d& homography);

/// The same by singular values (Faugeras, Lustman 1988). Errors as above.
Result<std::vector<HomographyDecomposition>> decompose_homography_numerically(const Eigen::Matrix3d& homography);

}  // namespace groundscale
