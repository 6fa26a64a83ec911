#pragma once

#include <Eigen/Core>

namespace groundscale {

/// Cross product matrix: skew(a) b = a x b.
Eigen::Matrix3d skew(const Eigen::Vector3d& a);

/// Rotation by |w| about w (Rodrigues), exact to rounding for every |w|.
Eigen::Matrix3d exp_so3(const Eigen::Vector3d& w);

/// Inverse of exp_so3, |result| <= pi; accurate near 0 and near pi.
Eigen::Vector3d log_so3(const Eigen::Matrix3d& rotation);

/// Angle of a rotation in [0, pi], accurate near 0 where the arc cosine of the trace isn't.
double rotation_angle(const Eigen::Matrix3d& rotation);

/// Nearest rotation in the Frobenius norm, of a matrix with a positive determinant.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix);

/// Two unit vectors that span the plane across t, as columns: the directions that the covariance of t refers to.
Eigen::Matrix<double, 3, 2> tangents_of(const Eigen::Vector3d& t);

}  // namespace groundscale
