#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <fmt/format.h>

#include "groundscale/plane/plane_homography_internal.hpp"

namespace groundscale {
namespace {

/// H with the smallest sum |ray2 x H ray1|^2, |H| = 1: least eigenvector of the normal equations.
Eigen::Matrix3d fit_homography(const std::vector<Transfer>& transfers, std::span<const int> chosen) {
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (const int i : chosen) {
    const Transfer& transfer = transfers[static_cast<std::size_t>(i)];
    // |ray2 x v|^2 = v^T (I - ray2 ray2^T) v for a unit ray2, v = H ray1, columns of H stacked.
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - transfer.ray2 * transfer.ray2.transpose();
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        normal.block<3, 3>(3 * a, 3 * b) += transfer.ray1(a) * transfer.ray1(b) * across;
      }
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(normal);
  Eigen::Matrix3d homography = solver.eigenvectors().col(0).reshaped(3, 3);
  // Rays have a sense: points stay in front, so H ray1 points along ray2.
  double sense = 0.0;
  for (const int i : chosen) {
    const Transfer& transfer = transfers[static_cast<std::size_t>(i)];
    sense += transfer.ray2.dot(homography * transfer.ray1);
  }
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
