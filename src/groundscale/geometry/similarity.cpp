#include "groundscale/geometry/similarity.hpp"

#include <cmath>
#include <cstddef>

#include <Eigen/LU>
#include <Eigen/SVD>

namespace groundscale {

Result<Similarity> align_points(const std::vector<Eigen::Vector3d>& source, const std::vector<Eigen::Vector3d>& target,
                                bool with_scale) {
  GS_CHECK(source.size() == target.size(), "corresponding points come in pairs");
  if (source.size() < 3) return Error{ErrorCode::kTooFewMatches, "alignment needs at least three points"};
  const double count = static_cast<double>(source.size());
  Eigen::Vector3d source_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d target_mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < source.size(); ++i) {
    source_mean += source[i] / count;
    target_mean += target[i] / count;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double source_variance = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    covariance += (target[i] - target_mean) * (source[i] - source_mean).transpose() / count;
    source_variance += (source[i] - source_mean).squaredNorm() / count;
  }
  constexpr double kSpot = 1e-12;  // of the distance from the origin: beneath, the spread is rounding
  if (!(std::sqrt(source_variance) > kSpot * source_mean.norm())) {
    return Error{ErrorCode::kTooFewMatches, "alignment of points that lie on one spot"};
  }

  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) signs.z() = -1.0;
  Similarity result;
  result.rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  if (with_scale) result.scale = svd.singularValues().dot(signs) / source_variance;
  result.translation = target_mean - result.scale * (result.rotation * source_mean);
  return result;
}

}  // namespace groundscale
