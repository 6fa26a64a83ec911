#include "groundscale/mapping/resection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/mapping/p3p_internal.hpp"
#include "groundscale/mapping/reprojection_internal.hpp"

namespace groundscale {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kLostPx = 100.0;  ///< A point that leaves the field costs as much as one that is far off.

/// |pixel - project(R X + t)| / sd_px; infinite where it doesn't project.
double error_of(const PointSight& sight, const Camera& camera, const RigidTransform& cam_from_world) {
  const auto pixel = camera.project(cam_from_world * sight.point_in_world);
  return pixel ? (*pixel - sight.pixel).norm() / sight.sd_px : std::numeric_limits<double>::infinity();
}

class PoseCost {
 public:
  PoseCost(const std::vector<PointSight>& sights, const Camera& camera) : sights_(sights), camera_(camera) {}

  double operator()(const RigidTransform& cam_from_world, const CauchyLoss& loss) const {
    double cost = 0.0;
    for (const PointSight& sight : sights_) {
      cost += loss.rho(std::min(kLostPx, error_of(sight, camera_, cam_from_world)));
    }
    return cost;
  }

  double median_error(const RigidTransform& cam_from_world) const {
    std::vector<double> errors;
    errors.reserve(sights_.size());
    for (const PointSight& sight : sights_) errors.push_back(error_of(sight, camera_, cam_from_world));
    return quantile(std::move(errors), 0.5);
  }

  /// Normal equations; `gradient` may be null.
  Matrix6 linearise(const RigidTransform& cam_from_world, const CauchyLoss& loss, Vector6* gradient) const {
    Matrix6 information = Matrix6::Zero();
    if (gradient != nullptr) gradient->setZero();
    for (const PointSight& sight : sights_) {
      const auto seen = reproject(camera_, cam_from_world, sight.point_in_world);
      if (!seen) continue;
      const Eigen::Vector2d error = seen->pixel - sight.pixel;
      const double weight = loss.weight(error.norm() / sight.sd_px) / (sight.sd_px * sight.sd_px);
      information.noalias() += weight * seen->by_pose.transpose() * seen->by_pose;
      if (gradient != nullptr) gradient->noalias() += weight * seen->by_pose.transpose() * error;
    }
    return information;
  }

 private:
  const std::vector<PointSight>& sights_;
  const Camera& camera_;
};

RigidTransform moved(const RigidTransform& pose, const Vector6& step) {
  return {exp_so3(step.head<3>()) * pose.rotation, pose.translation + step.tail<3>()};
}

/// One damped step that doesn't raise the cost; nothing where none was found.
std::optional<RigidTransform> lower(const PoseCost& cost_of, const RigidTransform& pose, const CauchyLoss& loss,
                                    double& damping, double& cost) {
  Vector6 gradient;
  const Matrix6 information = cost_of.linearise(pose, loss, &gradient);
  constexpr int kMaxAttempts = 5;
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt, damping *= 10.0) {
    Matrix6 damped = information;
    damped.diagonal() *= 1.0 + damping;
    const Vector6 step = damped.ldlt().solve(-gradient);
    if (!step.allFinite()) continue;
    const RigidTransform next = moved(pose, step);
    const double next_cost = cost_of(next, loss);
    if (next_cost > cost) continue;
    cost = next_cost;
    damping = std::max(1e-9, damping * 0.01);
    return next;
  }
  return std::nullopt;
}

RigidTransform minimise(const PoseCost& cost_of, RigidTransform pose, const ResectionOptions& options) {
  constexpr double kMinGain = 1e-8;
  double damping = 1e-4;
  // Wide first: the majority pulls, even where a minority agrees with the guess as it is (cars that drive along).
  CauchyLoss loss{std::min(kLostPx, std::max(options.loss_px, 2.0 * cost_of.median_error(pose)))};
  double cost = cost_of(pose, loss);
  for (int k = 0; k < options.max_iterations; ++k) {
    const double before = cost;
    const auto next = lower(cost_of, pose, loss, damping, cost);
    if (next) pose = *next;
    if (loss.bound > options.loss_px) {
      // Lowered whatever the median does, so that it comes down to loss_px in the end.
      loss.bound = std::max(options.loss_px, std::min(0.75 * loss.bound, cost_of.median_error(pose)));
      cost = cost_of(pose, loss);
      damping = 1e-4;
      continue;
    }
    if (!next || before - cost < kMinGain * before) break;
  }
  pose.rotation = nearest_rotation(pose.rotation);
  return pose;
}

/// Inverse of the information, scaled to a unit diagonal first; nothing where it doesn't exist.
std::optional<Matrix6> inverse_of(const Matrix6& information) {
  constexpr double kMinReciprocalCondition = 1e-13;
  const Vector6 scale = information.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return std::nullopt;
  const Matrix6 scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::LDLT<Matrix6> decomposed(scaled);
  if (decomposed.info() != Eigen::Success || !(decomposed.rcond() > kMinReciprocalCondition)) return std::nullopt;
  return scale.asDiagonal() * decomposed.solve(Matrix6::Identity()) * scale.asDiagonal();
}

struct PoseProblem {
  using Model = RigidTransform;
  static constexpr int kSampleSize = 3;

  const std::vector<PointSight>& sights;
  const Camera& camera;
  std::vector<int> usable;            ///< Indices of sights whose pixel has a ray.
  std::vector<Eigen::Vector3d> rays;  ///< Of those.
  double max_error_px;

  int count() const { return static_cast<int>(usable.size()); }
  double max_error() const { return max_error_px; }
  std::vector<Model> fit(std::span<const int> sample) const {
    std::array<Eigen::Vector3d, kSampleSize> points;
    std::array<Eigen::Vector3d, kSampleSize> chosen;
    for (std::size_t k = 0; k < kSampleSize; ++k) {
      const auto item = static_cast<std::size_t>(sample[k]);
      points[k] = sights[static_cast<std::size_t>(usable[item])].point_in_world;
      chosen[k] = rays[item];
    }
    return three_point_poses(points, chosen);
  }
  double error(const Model& model, int item) const {
    return error_of(sights[static_cast<std::size_t>(usable[static_cast<std::size_t>(item)])], camera, model);
  }
};

Error too_few(std::size_t found, std::size_t count, int needed) {
  return {ErrorCode::kTooFewMatches,
          fmt::format("{} of {} points agree with one pose, {} needed", found, count, needed)};
}

}  // namespace

void visit_fields(ResectionOptions& options, FieldVisitor& visitor) {
  visitor.field(
      {.key = "loss_px", .unit = "px", .help = "bound of the Cauchy loss of the pose", .min = 0.01, .max = 100},
      options.loss_px);
  visitor.field(
      {.key = "max_error_px", .unit = "px", .help = "reprojection error of an inlier", .min = 0.05, .max = 100},
      options.max_error_px);
  visitor.field({.key = "max_iterations", .unit = "", .help = "steps that refine a pose", .min = 1, .max = 1000},
                options.max_iterations);
  visitor.field({.key = "min_inliers", .unit = "", .help = "fewer inliers give no pose", .min = 4, .max = 10000},
                options.min_inliers);
  visitor.group("ransac", options.ransac);
}

Result<Resection> refine_pose(const std::vector<PointSight>& sights, const Camera& camera,
                              const RigidTransform& cam_from_world_guess, const ResectionOptions& options) {
  if (static_cast<int>(sights.size()) < options.min_inliers) {
    return too_few(sights.size(), sights.size(), options.min_inliers);
  }
  const PoseCost cost_of(sights, camera);
  Resection result;
  result.cam_from_world = minimise(cost_of, cam_from_world_guess, options);
  double squares = 0.0;
  double normalised_squares = 0.0;
  for (std::size_t k = 0; k < sights.size(); ++k) {
    const double error = error_of(sights[k], camera, result.cam_from_world);
    if (!(error <= options.max_error_px)) continue;
    result.inliers.push_back(static_cast<int>(k));
    normalised_squares += error * error;
    squares += error * error * sights[k].sd_px * sights[k].sd_px;
  }
  if (static_cast<int>(result.inliers.size()) < options.min_inliers) {
    return too_few(result.inliers.size(), sights.size(), options.min_inliers);
  }
  const auto count = static_cast<double>(result.inliers.size());
  result.rms_px = std::sqrt(squares / count);
  const auto inverse = inverse_of(cost_of.linearise(result.cam_from_world, CauchyLoss{options.loss_px}, nullptr));
  if (!inverse) return Error{ErrorCode::kNotConverged, "the points that are seen don't fix a pose"};
  // Two coordinates a sight, six parameters.
  result.covariance = normalised_squares / std::max(1.0, 2.0 * count - 6.0) * *inverse;
  return result;
}

Result<Resection> resect(const std::vector<PointSight>& sights, const Camera& camera, const ResectionOptions& options,
                         Rng& rng) {
  PoseProblem problem{sights, camera, {}, {}, options.max_error_px};
  for (std::size_t k = 0; k < sights.size(); ++k) {
    const auto ray = camera.ray(sights[k].pixel);
    if (!ray) continue;
    problem.usable.push_back(static_cast<int>(k));
    problem.rays.push_back(*ray);
  }
  if (problem.count() < options.min_inliers) return too_few(problem.usable.size(), sights.size(), options.min_inliers);
  const auto found = ransac(problem, options.ransac, rng);
  if (!found) return too_few(0, sights.size(), options.min_inliers);
  return refine_pose(sights, camera, found->model, options);
}

}  // namespace groundscale
