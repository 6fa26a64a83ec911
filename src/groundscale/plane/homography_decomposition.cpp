#include "groundscale/plane/homography_decomposition.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace groundscale {
namespace {

// |t| / h below which a homography counts as a rotation.
constexpr double kMinMotion = 1e-9;

Error rotation_only() {
  return {ErrorCode::kDegenerateMotion, "the homography is a rotation: no motion, or no plane at finite distance"};
}

Result<void> check_sense(const Eigen::Matrix3d& homography) {
  if (homography.allFinite() && homography.determinant() > 0.0) return {};
  return Error{ErrorCode::kNotGround, "the homography turns the plane's back to one of the cameras"};
}

/// R and t that go with a normal, given H = R + t n^T exactly: t* = R^T t from S n, R = H (I + t* n^T)^-1.
HomographyDecomposition with_normal(const Eigen::Matrix3d& euclidean, const Eigen::Matrix3d& s,
                                    const Eigen::Vector3d& normal) {
  // det H = 1 + n.t*, n^T S n = 2 n.t* + |t*|^2, S n = t* + n (n.t* + |t*|^2).
  const double towards = euclidean.determinant() - 1.0;
  const Eigen::Vector3d s_normal = s * normal;
  const double squared = normal.dot(s_normal) - 2.0 * towards;
  const Eigen::Vector3d t_star = s_normal - normal * (towards + squared);
  HomographyDecomposition solution;
  solution.normal = normal;
  solution.rotation = euclidean - euclidean * t_star * normal.transpose() / (1.0 + normal.dot(t_star));
  solution.translation = solution.rotation * t_star;
  return solution;
}

void add_both_senses(const HomographyDecomposition& solution, std::vector<HomographyDecomposition>& solutions) {
  solutions.push_back(solution);
  solutions.push_back({solution.rotation, -solution.translation, -solution.normal});
}

}  // namespace

Result<std::vector<HomographyDecomposition>> decompose_homography(const Eigen::Matrix3d& homography) {
  if (const auto checked = check_sense(homography); !checked) return checked.error();
  // Of a Euclidean homography the middle singular value is 1.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> squares(homography.transpose() * homography,
                                                               Eigen::EigenvaluesOnly);
  const Eigen::Matrix3d euclidean = homography / std::sqrt(squares.eigenvalues()(1));
  const Eigen::Matrix3d s = euclidean.transpose() * euclidean - Eigen::Matrix3d::Identity();
  // Entries of S are 2 n_i a_i on the diagonal; the largest of them decides which row is used.
  Eigen::Index row = 0;
  const double largest = s.diagonal().cwiseAbs().maxCoeff(&row);
  if (!(largest > kMinMotion)) return rotation_only();

  // -cofactors(S) = w w^T, w = n x a.
  Eigen::Matrix3d outer;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3;
      const int i2 = (i + 2) % 3;
      const int j1 = (j + 1) % 3;
      const int j2 = (j + 2) % 3;
      outer(i, j) = s(i1, j2) * s(i2, j1) - s(i1, j1) * s(i2, j2);
    }
  }
  Eigen::Index column = 0;
  const double squared = outer.diagonal().maxCoeff(&column);
  const Eigen::Vector3d w =
      squared > 0.0 ? Eigen::Vector3d(outer.col(column) / std::sqrt(squared)) : Eigen::Vector3d::Zero();
  const Eigen::Vector3d across = Eigen::Vector3d::Unit(row).cross(w);
  std::vector<HomographyDecomposition> solutions;
  for (const double sign : {1.0, -1.0}) {
    const Eigen::Vector3d normal = (s.col(row) + sign * across).normalized();
    add_both_senses(with_normal(euclidean, s, normal), solutions);
  }
  return solutions;
}

Result<std::vector<HomographyDecomposition>> decompose_homography_numerically(const Eigen::Matrix3d& homography) {
  if (const auto checked = check_sense(homography); !checked) return checked.error();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(homography, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (svd.info() != Eigen::Success) return rotation_only();
  const Eigen::Vector3d d = svd.singularValues() / svd.singularValues()(1);
  const double width = d(0) * d(0) - d(2) * d(2);
  if (!(width > kMinMotion)) return rotation_only();
  // det U det V = 1, so theirs is the case d' > 0.
  const double x1 = std::sqrt(std::max(0.0, d(0) * d(0) - 1.0) / width);
  const double x3 = std::sqrt(std::max(0.0, 1.0 - d(2) * d(2)) / width);
  std::vector<HomographyDecomposition> solutions;
  for (const double sign : {1.0, -1.0}) {
    const Eigen::Vector3d normal(x1, 0.0, sign * x3);
    const Eigen::Vector3d translation = (d(0) - d(2)) * Eigen::Vector3d(x1, 0.0, -sign * x3);
    const double sine = sign * (d(0) - d(2)) * x1 * x3;
    const double cosine = (1.0 + d(0) * d(2)) / (d(0) + d(2));
    Eigen::Matrix3d rotation;
    rotation << cosine, 0.0, -sine, 0.0, 1.0, 0.0, sine, 0.0, cosine;
    add_both_senses(
        {svd.matrixU() * rotation * svd.matrixV().transpose(), svd.matrixU() * translation, svd.matrixV() * normal},
        solutions);
  }
  return solutions;
}

}  // namespace groundscale
