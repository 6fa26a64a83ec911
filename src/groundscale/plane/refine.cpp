#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <opencv2/core/optim.hpp>

#include "groundscale/estimation/levenberg_marquardt.hpp"
#include "groundscale/estimation/robust.hpp"
#include "groundscale/plane/normal_prior_internal.hpp"
#include "groundscale/plane/refine_internal.hpp"

namespace groundscale {
namespace {

/// The symmetric transfer error as a function of m.
class TransferCost {
 public:
  using State = Eigen::Vector3d;
  static constexpr int kParameters = 3;

  TransferCost(const RoadObservations& observations, const std::vector<Transfer>& transfers,
               const PlaneOptions& options)
      : observations_(observations),
        transfers_(transfers),
        loss_{options.huber_px},
        prior_(observations, options),
        prior_weight_(2.0 * prior_worth(options)) {}

  double cost(const Eigen::Vector3d& m) const {
    double cost = prior_weight_ * prior_.cost(m);
    for (const Transfer& transfer : transfers_) {
      const auto error = error_of(m, transfer);
      // A point that leaves the camera's field costs as much as one that is far off.
      cost += transfer.weight * (error ? loss_.rho(error->forward.norm()) + loss_.rho(error->backward.norm())
                                       : 2.0 * loss_.rho(kLostTransferPx));
    }
    return cost;
  }

  NormalEquations<3> linearise(const Eigen::Vector3d& m) const {
    NormalEquations<3> equations;
    equations.information = prior_weight_ * prior_.hessian(m);
    equations.gradient = prior_weight_ * prior_.gradient(m);
    for (const Transfer& transfer : transfers_) {
      const auto error = error_of(m, transfer);
      if (!error) continue;
      add(transfer.weight, error->forward, error->forward_by_m, equations);
      add(transfer.weight, error->backward, error->backward_by_m, equations);
    }
    return equations;
  }

  Eigen::Vector3d moved(const Eigen::Vector3d& m, const Eigen::Vector3d& step) const { return m + step; }

 private:
  std::optional<TransferError> error_of(const Eigen::Vector3d& m, const Transfer& transfer) const {
    const RigidTransform& pose = observations_.cam_from_reference[static_cast<std::size_t>(transfer.view)];
    return transfer_error(*observations_.camera, pose, m, transfer);
  }

  void add(double point_weight, const Eigen::Vector2d& error, const Eigen::Matrix<double, 2, 3>& by_m,
           NormalEquations<3>& equations) const {
    const double weight = point_weight * loss_.weight(error.norm());
    equations.information.noalias() += weight * by_m.transpose() * by_m;
    equations.gradient.noalias() += weight * by_m.transpose() * error;
  }

  const RoadObservations& observations_;
  const std::vector<Transfer>& transfers_;
  HuberLoss loss_;
  NormalPrior prior_;
  double prior_weight_;
};

/// The paper's way. OpenCV's downhill simplex over m, scaled to its start.
Eigen::Vector3d refine_by_nelder_mead(const TransferCost& cost_of, const Eigen::Vector3d& start) {
  class Function final : public cv::MinProblemSolver::Function {
   public:
    Function(const TransferCost& cost, double unit) : cost_(cost), unit_(unit) {}
    int getDims() const override { return 3; }
    double calc(const double* x) const override { return cost_.cost(unit_ * Eigen::Vector3d(x[0], x[1], x[2])); }

   private:
    const TransferCost& cost_;
    double unit_;
  };
  const double unit = start.norm();
  const double step = 0.05;  // 5 % of |m|, about 3 degrees
  const cv::Ptr<cv::MinProblemSolver::Function> function = cv::makePtr<Function>(cost_of, unit);
  const auto solver = cv::DownhillSolver::create(function, cv::Mat_<double>({3, 1}, {step, step, step}),
                                                 {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 400, 1e-7});
  cv::Mat point = (cv::Mat_<double>(1, 3) << start.x() / unit, start.y() / unit, start.z() / unit);
  solver->minimize(point);
  return unit * Eigen::Vector3d(point.at<double>(0), point.at<double>(1), point.at<double>(2));
}

}  // namespace

double prior_worth(const PlaneOptions& options) { return options.point_sd_px * options.point_sd_px; }

Eigen::Vector3d refine_plane(const RoadObservations& observations, const std::vector<Transfer>& transfers,
                             const Eigen::Vector3d& start, const PlaneOptions& options) {
  const TransferCost cost(observations, transfers, options);
  return options.refinement == PlaneRefinement::kNelderMead ? refine_by_nelder_mead(cost, start)
                                                            : levenberg_marquardt(cost, start);
}

Eigen::Matrix3d covariance_of_plane(const RoadObservations& observations, const std::vector<Transfer>& transfers,
                                    const Eigen::Vector3d& m, const PlaneOptions& options) {
  const HuberLoss loss{options.huber_px};
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 5> by_motion = Eigen::Matrix<double, 3, 5>::Zero();
  double squares = 0.0;
  double weights = 0.0;
  for (const Transfer& transfer : transfers) {
    const RigidTransform& pose = observations.cam_from_reference[static_cast<std::size_t>(transfer.view)];
    const auto error = transfer_error(*observations.camera, pose, m, transfer);
    if (!error) continue;
    const double weight = transfer.weight * loss.weight(error->forward.norm());
    const Eigen::Matrix3d squared = error->forward_by_m.transpose() * error->forward_by_m;
    information += weight * squared;
    spread += weight * transfer.weight * squared;
    squares += weight * error->forward.squaredNorm();
    weights += transfer.weight;
    if (transfer.view != 1) continue;
    const auto by_view = forward_by_motion(*observations.camera, pose, m, transfer);
    if (by_view) by_motion += weight * error->forward_by_m.transpose() * *by_view;
  }
  // Of two coordinates a transfer, three parameters. A point's weight says how much it counts, not how precise it is,
  // so the covariance is A^-1 B A^-1 with B = sum w^2 J^T J.
  const auto count = static_cast<double>(transfers.size());
  const double variance = squares / std::max(1e-12, 2.0 * weights) * (2.0 * count / std::max(1.0, 2.0 * count - 3.0));
  const Eigen::Matrix3d prior_information = prior_worth(options) * NormalPrior(observations, options).hessian(m);
  information += prior_information;
  spread += prior_information;
  const Eigen::Matrix3d inverse = information.ldlt().solve(Eigen::Matrix3d::Identity());
  const Eigen::Matrix<double, 3, 5> m_by_motion = -inverse * by_motion;
  return variance * inverse * spread * inverse + m_by_motion * observations.motion_covariance * m_by_motion.transpose();
}

}  // namespace groundscale
