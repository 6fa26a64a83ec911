#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

#include "groundscale/estimation/levenberg_marquardt.hpp"
#include "groundscale/estimation/robust.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/plane/motion_refine_internal.hpp"
#include "groundscale/plane/normal_prior_internal.hpp"
#include "groundscale/plane/refine_internal.hpp"

namespace groundscale {
namespace {

/// Parameters: m, rotation vector left of R, two tangents of t in units of |t|.
class MotionCost {
 public:
  using State = MotionAndPlane;
  static constexpr int kParameters = 8;

  MotionCost(const RoadObservations& observations, const std::vector<Transfer>& transfers, const PlaneOptions& options)
      : observations_(observations),
        transfers_(transfers),
        loss_{options.huber_px},
        prior_(observations, options),
        prior_weight_(2.0 * prior_worth(options)) {}

  double cost(const MotionAndPlane& at) const {
    double cost = prior_weight_ * prior_.cost(at.m);
    for (const Transfer& transfer : transfers_) {
      const auto error = transfer_error(*observations_.camera, at.cam2_from_cam1, at.m, transfer);
      cost += transfer.weight * (error ? loss_.rho(error->forward.norm()) + loss_.rho(error->backward.norm())
                                       : 2.0 * loss_.rho(kLostTransferPx));
    }
    return cost;
  }

  NormalEquations<8> linearise(const MotionAndPlane& at) const {
    NormalEquations<8> equations;
    equations.information.topLeftCorner<3, 3>() = prior_weight_ * prior_.hessian(at.m);
    equations.gradient.head<3>() = prior_weight_ * prior_.gradient(at.m);
    const Camera& camera = *observations_.camera;
    for (const Transfer& transfer : transfers_) {
      const auto error = transfer_error(camera, at.cam2_from_cam1, at.m, transfer);
      const auto forward = forward_by_motion(camera, at.cam2_from_cam1, at.m, transfer);
      const auto backward = backward_by_motion(camera, at.cam2_from_cam1, at.m, transfer);
      if (!error || !forward || !backward) continue;
      add(transfer.weight, error->forward, error->forward_by_m, *forward, equations);
      add(transfer.weight, error->backward, error->backward_by_m, *backward, equations);
    }
    return equations;
  }

  MotionAndPlane moved(const MotionAndPlane& at, const Eigen::Matrix<double, 8, 1>& step) const {
    const Eigen::Vector3d& t = at.cam2_from_cam1.translation;
    MotionAndPlane next;
    next.m = at.m + step.head<3>();
    next.cam2_from_cam1.rotation = exp_so3(step.segment<3>(3)) * at.cam2_from_cam1.rotation;
    next.cam2_from_cam1.translation = t.norm() * (t + tangents_of(t) * step.tail<2>()).normalized();
    return next;
  }

 private:
  void add(double point_weight, const Eigen::Vector2d& error, const Eigen::Matrix<double, 2, 3>& by_m,
           const Eigen::Matrix<double, 2, 5>& by_motion, NormalEquations<8>& equations) const {
    Eigen::Matrix<double, 2, 8> by_all;
    by_all << by_m, by_motion;
    const double weight = point_weight * loss_.weight(error.norm());
    equations.information.noalias() += weight * by_all.transpose() * by_all;
    equations.gradient.noalias() += weight * by_all.transpose() * error;
  }

  const RoadObservations& observations_;
  const std::vector<Transfer>& transfers_;
  HuberLoss loss_;
  NormalPrior prior_;
  double prior_weight_;
};

}  // namespace

std::optional<Eigen::Matrix<double, 2, 5>> backward_by_motion(const Camera& camera,
                                                              const RigidTransform& cam2_from_cam1,
                                                              const Eigen::Vector3d& m, const Transfer& transfer) {
  // Ray b = v (1 + m.s) - s (m.v) with v = R^T ray2, s = R^T t as in transfer_error. R <- exp(w) R turns v by
  // R^T (ray2 x w) and s by R^T (t x w).
  const Eigen::Matrix3d back = cam2_from_cam1.rotation.transpose();
  const Eigen::Vector3d v = back * transfer.ray2;
  const Eigen::Vector3d s = back * cam2_from_cam1.translation;
  Eigen::Matrix<double, 2, 3> by_ray;
  if (!camera.project(v * (1.0 + m.dot(s)) - s * m.dot(v), &by_ray)) return std::nullopt;
  Eigen::Matrix<double, 3, 5> v_by = Eigen::Matrix<double, 3, 5>::Zero();
  v_by.leftCols<3>() = back * skew(transfer.ray2);
  Eigen::Matrix<double, 3, 5> s_by;
  s_by.leftCols<3>() = back * skew(cam2_from_cam1.translation);
  s_by.rightCols<2>() = back * tangents_of(cam2_from_cam1.translation);
  const Eigen::Matrix<double, 3, 5> ray_by =
      v_by * (1.0 + m.dot(s)) + v * (m.transpose() * s_by) - s_by * m.dot(v) - s * (m.transpose() * v_by);
  return -by_ray * ray_by;
}

MotionAndPlane refine_motion_and_plane(const RoadObservations& observations, const std::vector<Transfer>& transfers,
                                       const MotionAndPlane& start, const PlaneOptions& options) {
  return levenberg_marquardt(MotionCost(observations, transfers, options), start);
}

Eigen::Matrix3d covariance_with_free_motion(const RoadObservations& observations,
                                            const std::vector<Transfer>& transfers, const MotionAndPlane& at,
                                            const PlaneOptions& options, bool with_prior) {
  const HuberLoss loss{options.huber_px};
  Eigen::Matrix<double, 8, 8> information = Eigen::Matrix<double, 8, 8>::Zero();
  Eigen::Matrix<double, 8, 8> spread = Eigen::Matrix<double, 8, 8>::Zero();
  double squares = 0.0;
  double weights = 0.0;
  for (const Transfer& transfer : transfers) {
    const auto error = transfer_error(*observations.camera, at.cam2_from_cam1, at.m, transfer);
    const auto by_motion = forward_by_motion(*observations.camera, at.cam2_from_cam1, at.m, transfer);
    if (!error || !by_motion) continue;
    Eigen::Matrix<double, 2, 8> by_all;
    by_all << error->forward_by_m, *by_motion;
    const double weight = transfer.weight * loss.weight(error->forward.norm());
    const Eigen::Matrix<double, 8, 8> squared = by_all.transpose() * by_all;
    information += weight * squared;
    spread += weight * transfer.weight * squared;
    squares += weight * error->forward.squaredNorm();
    weights += transfer.weight;
  }
  if (with_prior) {
    const Eigen::Matrix3d prior_information = prior_worth(options) * NormalPrior(observations, options).hessian(at.m);
    information.topLeftCorner<3, 3>() += prior_information;
    spread.topLeftCorner<3, 3>() += prior_information;
  }
  // As in covariance_of_plane, with eight parameters; all as numbers of about 1, so that what is open can be told.
  const Eigen::Matrix<double, 8, 1> unit = information.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  const Eigen::Matrix<double, 8, 8> scaled = unit.asDiagonal() * information * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 8, 8>> solver(scaled);
  constexpr double kOpen = 1e-12;
  if (!(solver.eigenvalues()(0) > kOpen)) {
    return Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  const Eigen::Matrix<double, 8, 8> inverse = unit.asDiagonal() * solver.eigenvectors() *
                                              solver.eigenvalues().cwiseInverse().asDiagonal() *
                                              solver.eigenvectors().transpose() * unit.asDiagonal();
  const auto count = static_cast<double>(transfers.size());
  const double variance = squares / std::max(1e-12, 2.0 * weights) * (2.0 * count / std::max(1.0, 2.0 * count - 8.0));
  return variance * (inverse * spread * inverse).topLeftCorner<3, 3>();
}

}  // namespace groundscale
