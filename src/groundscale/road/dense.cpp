#include "groundscale/road/dense.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <fmt/format.h>
#include <opencv2/core/optim.hpp>

#include "groundscale/road/road_alignment_internal.hpp"

namespace groundscale {
namespace {

/// What R and t, taken as known, add to the covariance of m.
Eigen::Matrix3d covariance_by_motion(const RoadObservations& observations, const Aligned& aligned,
                                     const NormalPrior& prior) {
  const Eigen::MatrixXd basis = basis_of(FreeParameters::kPlane, aligned.state);
  PhotometricMatrix information = aligned.sums.information;
  information.block<3, 3>(6, 6) += prior.hessian(aligned.state.m);
  const Eigen::Matrix<double, kPhotometricSize, 5> by_motion =
      information * basis_of(FreeParameters::kPlaneAndMotion, aligned.state).leftCols<5>();
  const Eigen::Matrix<double, 5, 5> own = basis.transpose() * information * basis;
  const Eigen::Matrix<double, 5, 5> by = -own.ldlt().solve(Eigen::Matrix<double, 5, 5>(basis.transpose() * by_motion));
  return (by * observations.motion_covariance * by.transpose()).topLeftCorner<3, 3>();
}

/// The score of Song and Chandraker for a plane (h, n1, n3): 1 - rho^-SAD with rho = 1.5 is least where the mean
/// absolute difference is. Mean and sd of the grey levels are made equal first, which theirs doesn't.
class ScoreFunction final : public cv::MinProblemSolver::Function {
 public:
  ScoreFunction(const PhotometricLevel& level, const PhotometricState& start) : level_(level), start_(start) {}
  int getDims() const override { return 3; }

  Eigen::Vector3d m_of(const double* x) const {
    const GroundPlane plane = GroundPlane::from_inverse_form(start_.m);
    const Eigen::Vector3d& n = plane.normal_in_cam;
    const double n1 = n.x() + x[0];
    const double n3 = n.z() + x[1];
    const double rest = std::max(0.0, 1.0 - n1 * n1 - n3 * n3);
    return Eigen::Vector3d(n1, std::copysign(std::sqrt(rest), n.y()), n3).normalized() * std::exp(-x[2]) / plane.height;
  }

  double calc(const double* x) const override {
    PhotometricState state = start_;
    state.m = m_of(x);
    level_.match_brightness(state);
    const Eigen::Matrix3d homography = state.homography();
    double sum = 0.0;
    double weight = 0.0;
    for (const RoadPixel& pixel : level_.pixels()) {
      const auto grey = level_.grey2(pixel, homography);
      if (!grey) continue;
      sum += pixel.weight * std::abs(pixel.grey - state.gain * *grey - state.offset);
      weight += pixel.weight;
    }
    constexpr double kBase = 1.5;
    return weight > 0.0 ? 1.0 - std::pow(kBase, -sum / weight) : 1.0;
  }

 private:
  const PhotometricLevel& level_;
  PhotometricState start_;
};

PhotometricState refine_by_score(const RoadObservations& observations, PhotometricState state,
                                 const PlaneOptions& options) {
  for (int size = options.dense.levels; size >= 0; --size) {
    const PhotometricLevel level(observations, state, options.dense, size);
    const cv::Ptr<cv::MinProblemSolver::Function> function = cv::makePtr<ScoreFunction>(level, state);
    const double step = 0.02 * (1 << size);  // of the height; and about a degree
    const auto solver = cv::DownhillSolver::create(function, cv::Mat_<double>({3, 1}, {step, step, step}),
                                                   {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 200, 1e-6});
    cv::Mat point = cv::Mat_<double>::zeros(1, 3);
    solver->minimize(point);
    state.m = static_cast<const ScoreFunction&>(*function).m_of(point.ptr<double>());
    level.match_brightness(state);
  }
  return state;
}

/// The state of an alignment that somebody else has done.
Aligned aligned_at(PhotometricLevel level, const PhotometricState& state, const PlaneOptions& options) {
  Aligned aligned;
  aligned.state = state;
  aligned.sd = level.robust_sd(state);
  level.weigh_squares(state, aligned.sd, options);
  aligned.sums = level.sums(state, aligned.sd, options.dense.loss_bound, true);
  aligned.correlation = level.correlation(state.homography());
  aligned.level.emplace(std::move(level));
  return aligned;
}

}  // namespace

Result<PlaneMeasurement> estimate_plane_dense(const RoadObservations& observations, const PlaneOptions& options,
                                              Rng& rng) {
  if (const auto usable = check_pixels(observations); !usable) return usable.error();
  const auto first = alignment_start(observations, options, rng);
  if (!first) return first.error();
  const PhotometricState start = search_nearby(observations, *first, options);
  const bool by_score = options.dense.refinement == DenseRefinement::kNelderMead;
  const NormalPrior prior = by_score ? NormalPrior() : NormalPrior(observations, options);
  Aligned aligned;
  if (!by_score) {
    auto found = align_road(observations, start, FreeParameters::kPlane, prior, options);
    if (!found) return found.error();
    aligned = std::move(*found);
  } else {
    aligned.state = refine_by_score(observations, start, options);
  }
  if (by_score)
    aligned = aligned_at(PhotometricLevel(observations, aligned.state, options.dense, 0), aligned.state, options);
  if (const auto good = check_alignment(aligned, *first, options); !good) return good.error();
  PlaneMeasurement measurement;
  measurement.initial_plane = GroundPlane::from_inverse_form(first->m);
  measurement.plane = GroundPlane::from_inverse_form(aligned.state.m);
  measurement.covariance_of_m =
      alignment_covariance(aligned, FreeParameters::kPlane, prior, options).topLeftCorner<3, 3>() +
      covariance_by_motion(observations, aligned, prior);
  if (const auto certain = check_certainty(measurement, options); !certain) return certain.error();
  find_points_on_plane(observations, aligned.state.motion, options.max_error_px, measurement);
  return measurement;
}

}  // namespace groundscale
