#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include "groundscale/plane/plane_homography_internal.hpp"

namespace groundscale {
namespace {

/// Linear map of rays after which they lie about (0, 0, 1) with a spread of 1 (Hartley 1997, for rays): without it the
/// few rows of the image that the road takes up leave H badly conditioned.
Eigen::Matrix3d conditioner(const std::vector<Eigen::Vector3d>& rays) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& ray : rays) mean += ray;
  const Eigen::Matrix3d to_axis = Eigen::Quaterniond::FromTwoVectors(mean, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  double squares = 0.0;
  for (const Eigen::Vector3d& ray : rays) squares += (to_axis * ray).head<2>().squaredNorm();
  const double spread = std::sqrt(squares / (2.0 * static_cast<double>(rays.size())));
  constexpr double kMinSpread = 1e-6;
  const double scale = 1.0 / std::max(kMinSpread, spread);
  return Eigen::Vector3d(scale, scale, 1.0).asDiagonal() * to_axis;
}

/// H with the smallest sum |ray2 x H ray1|^2 over conditioned rays: least eigenvector of the normal equations.
Eigen::Matrix3d fit_homography(const std::vector<Transfer>& transfers, std::span<const int> chosen) {
  std::vector<Eigen::Vector3d> rays1;
  std::vector<Eigen::Vector3d> rays2;
  for (const int i : chosen) {
    rays1.push_back(transfers[static_cast<std::size_t>(i)].ray1);
    rays2.push_back(transfers[static_cast<std::size_t>(i)].ray2);
  }
  const Eigen::Matrix3d condition1 = conditioner(rays1);
  const Eigen::Matrix3d condition2 = conditioner(rays2);
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t k = 0; k < rays1.size(); ++k) {
    const Eigen::Vector3d a = condition1 * rays1[k];
    const Eigen::Vector3d b = (condition2 * rays2[k]).normalized();
    // |b x v|^2 = v^T (I - b b^T) v for a unit b, v = H a, columns of H stacked.
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - b * b.transpose();
    for (int column = 0; column < 3; ++column) {
      for (int row = 0; row < 3; ++row) {
        normal.block<3, 3>(3 * row, 3 * column) += a(row) * a(column) * across;
      }
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(normal);
  const Eigen::Matrix3d conditioned = solver.eigenvectors().col(0).reshaped(3, 3);
  Eigen::Matrix3d homography = (condition2.inverse() * conditioned * condition1).normalized();
  // Rays have a sense: points stay in front, so H ray1 points along ray2.
  double sense = 0.0;
  for (std::size_t k = 0; k < rays1.size(); ++k) sense += rays2[k].dot(homography * rays1[k]);
  if (sense < 0.0) homography = -homography;
  return homography;
}

struct HomographyProblem {
  struct Model {
    Eigen::Matrix3d forth, back;
  };
  static constexpr int kSampleSize = 4;

  const Camera& camera;
  const std::vector<Transfer>& transfers;
  double max_error_px;

  int count() const { return static_cast<int>(transfers.size()); }
  double max_error() const { return max_error_px; }
  std::vector<Model> fit(std::span<const int> sample) const {
    const Eigen::Matrix3d forth = fit_homography(transfers, sample);
    Eigen::Matrix3d back;
    bool invertible = false;
    constexpr double kMinDeterminant = 1e-9;  // of |H| = 1: three of the four points in a line
    forth.computeInverseWithCheck(back, invertible, kMinDeterminant);
    if (!invertible) return {};
    return {Model{forth, back}};
  }
  double error(const Model& model, int item) const {
    const Transfer& transfer = transfers[static_cast<std::size_t>(item)];
    const auto pixel2 = camera.project(model.forth * transfer.ray1);
    const auto pixel1 = camera.project(model.back * transfer.ray2);
    if (!pixel1 || !pixel2) return std::numeric_limits<double>::infinity();
    return std::max((*pixel2 - transfer.pixel2).norm(), (*pixel1 - transfer.pixel1).norm());
  }
};

}  // namespace

Result<Eigen::Matrix3d> ransac_homography(const Camera& camera, const std::vector<Transfer>& transfers,
                                          const PlaneOptions& options, Rng& rng) {
  const HomographyProblem problem{camera, transfers, options.max_error_px};
  if (problem.count() < std::max(options.min_inliers, HomographyProblem::kSampleSize)) {
    return Error{ErrorCode::kTooFewMatches,
                 fmt::format("{} road matches, {} needed", transfers.size(), options.min_inliers)};
  }
  const auto found = ransac(problem, options.ransac, rng);
  if (!found) return Error{ErrorCode::kNotGround, "no homography agrees with the road matches"};
  return fit_homography(transfers, found->inliers);
}

}  // namespace groundscale
