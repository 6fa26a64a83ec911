#include "groundscale/road/road_alignment_internal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/plane/refine_internal.hpp"
#include "groundscale/plane/transfer_internal.hpp"

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
/// Of the cost, by a step: a 2000th of the sd of all road points together. The slope that is interpolated isn't that of
/// the interpolated image any nearer than that.
constexpr double kMinGain = 1e-7;

struct Step {
  PhotometricState state;
  PhotometricSums sums;
  double cost = 0.0;
  bool taken = false;
};

/// Minimisation at one size with the scale of the differences held.
class LevelSolver {
 public:
  LevelSolver(PhotometricLevel& level, FreeParameters free, const NormalPrior& prior, const PlaneOptions& options)
      : level_(level), free_(free), prior_(prior), options_(options) {}

  /// @return By how much the last step lowered the cost; large where it hasn't converged.
  double solve(Aligned& aligned) {
    aligned.sd = level_.robust_sd(aligned.state);
    level_.weigh_squares(aligned.state, aligned.sd, options_);
    Step now{aligned.state, sums_of(aligned.state, aligned.sd)};
    weight_ = now.sums.weight;
    now.cost = cost_of(now);
    double gain = 0.0;
    double damping = 1e-4;
    constexpr int kMaxIterations = 15;
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
      const Step next = step_from(now, aligned, damping);
      gain = next.taken ? now.cost - next.cost : 0.0;
      if (!next.taken) break;
      now = next;
      if (gain < kMinGain) break;
    }
    aligned.state = now.state;
    aligned.sums = now.sums;
    return gain;
  }

 private:
  PhotometricSums sums_of(const PhotometricState& state, double sd) const {
    return level_.sums(state, sd, options_.dense.loss_bound, free_ != FreeParameters::kPlane);
  }
  /// Pixels that leave the image cost as much as those that stay.
  double cost_of(const Step& step) const {
    constexpr double kMinShare = 0.3;
    if (!(step.sums.weight > kMinShare * weight_)) return std::numeric_limits<double>::infinity();
    return weight_ * step.sums.cost + prior_.cost(step.state.m);
  }

  Step step_from(const Step& now, const Aligned& aligned, double& damping) const {
    const Eigen::MatrixXd basis = basis_of(free_, now.state);
    PhotometricMatrix full = now.sums.information;
    PhotometricVector slope = now.sums.gradient;
    full.block<3, 3>(6, 6) += prior_.hessian(now.state.m);
    slope.segment<3>(6) += prior_.gradient(now.state.m);
    const Eigen::MatrixXd information = basis.transpose() * full * basis;
    const Eigen::VectorXd gradient = basis.transpose() * slope;
    constexpr int kMaxAttempts = 3;
    for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
      Eigen::MatrixXd damped = information;
      damped.diagonal() *= 1.0 + damping;
      const Eigen::VectorXd step = -damped.ldlt().solve(gradient);
      // What the step would gain if the cost were a parabola.
      const double promised = -0.5 * step.dot(gradient);
      if (promised < kMinGain) return now;
      if (step.allFinite()) {
        Step next{moved(now.state, basis * step, free_), {}};
        next.sums = sums_of(next.state, aligned.sd);
        next.cost = cost_of(next);
        next.taken = next.cost < now.cost;
        damping = std::max(1e-9, damping * 0.1);
        if (next.taken) return next;
      }
      damping = std::max(1e-3, damping * 100.0);
    }
    return now;
  }

  PhotometricLevel& level_;
  FreeParameters free_;
  const NormalPrior& prior_;
  const PlaneOptions& options_;
  double weight_ = 0.0;
};

/// The plane, its normal turned about the axis across the direction of travel, its height times a factor.
PhotometricState tilted(const PhotometricState& state, double pitch_rad, double height_factor) {
  const Eigen::Vector3d across = state.m.cross(state.motion.translation).normalized();
  PhotometricState changed = state;
  changed.m = exp_so3(pitch_rad * across) * state.m / height_factor;
  return changed;
}

PhotometricState best_of(const RoadObservations& observations, const std::vector<PhotometricState>& candidates,
                         const PhotometricState& start, const PlaneOptions& options) {
  DenseOptions few = options.dense;
  constexpr int kPixels = 600;
  few.max_pixels = std::min(kPixels, few.max_pixels);
  const PhotometricLevel level(observations, start, few, few.levels);
  PhotometricState best = start;
  double best_correlation = -1.0;
  for (const PhotometricState& candidate : candidates) {
    const double correlation = level.correlation(candidate.homography());
    if (correlation > best_correlation) {
      best_correlation = correlation;
      best = candidate;
    }
  }
  return best;
}

}  // namespace

Eigen::MatrixXd basis_of(FreeParameters free, const PhotometricState& state) {
  const auto identity = PhotometricMatrix::Identity();
  if (free == FreeParameters::kPlane) return identity.rightCols<5>();
  if (free == FreeParameters::kMotion) {
    Eigen::MatrixXd basis(kPhotometricSize, 8);
    basis << identity.leftCols<6>(), identity.rightCols<2>();
    return basis;
  }
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(kPhotometricSize, 10);
  basis.leftCols<3>() = identity.leftCols<3>();
  basis.block<3, 2>(3, 3) = tangents_of(state.motion.translation);
  basis.rightCols<5>() = identity.rightCols<5>();
  return basis;
}

PhotometricState moved(const PhotometricState& state, const PhotometricVector& step, FreeParameters free) {
  PhotometricState next = state;
  next.motion.rotation = exp_so3(step.head<3>()) * state.motion.rotation;
  next.motion.translation += step.segment<3>(3);
  if (free == FreeParameters::kPlaneAndMotion) {
    next.motion.translation *= state.motion.translation.norm() / next.motion.translation.norm();
  }
  next.m += step.segment<3>(6);
  // No camera changes its exposure by more from one frame to the next; a gain near zero would align anything.
  constexpr double kMaxGain = 2.0;
  next.gain = std::clamp(state.gain + step[9], 1.0 / kMaxGain, kMaxGain);
  next.offset += step[10];
  return next;
}

Result<void> check_pixels(const RoadObservations& observations) {
  GS_CHECK(observations.camera != nullptr && observations.cam_from_reference.size() >= 2, "two views and their camera");
  if (observations.images.size() < 2 || observations.images[0].empty() || observations.images[1].empty())
    return Error{ErrorCode::kBadInput, "the method needs the pixels of both views"};
  if (observations.region.empty()) return Error{ErrorCode::kTooFewMatches, "the road region is empty"};
  for (const Image* image : {&observations.images[0], &observations.images[1], &observations.region}) {
    if (image->width() != observations.camera->width() || image->height() != observations.camera->height()) {
      return Error{ErrorCode::kBadInput,
                   fmt::format("an image of {}x{} pixels where the camera has {}x{}", image->width(), image->height(),
                               observations.camera->width(), observations.camera->height())};
    }
  }
  if (!(observations.cam_from_reference[1].translation.norm() > 1e-9))
    return Error{ErrorCode::kDegenerateMotion, "without a baseline every plane looks the same"};
  return {};
}

Result<PhotometricState> alignment_start(const RoadObservations& observations, const PlaneOptions& options, Rng& rng) {
  PhotometricState start;
  start.motion = observations.cam_from_reference[1];
  if (observations.predicted_plane) {
    start.m = observations.predicted_plane->inverse_form();
    return start;
  }
  if (static_cast<int>(observations.points.size()) >= options.min_inliers) {
    const auto sparse = estimate_plane_sparse(observations, options, rng);
    if (sparse) {
      start.m = sparse->plane.inverse_form();
      return start;
    }
  }
  if (observations.expected_normal.isZero())
    return Error{ErrorCode::kNotGround, "neither a plane nor a normal is known to start from"};
  // Heights of a third to thirty steps.
  const double step = start.motion.translation.norm();
  std::vector<PhotometricState> candidates;
  for (double height = 0.3 * step; height < 30.0 * step; height *= 1.05) {
    candidates.push_back(start);
    candidates.back().m = observations.expected_normal / height;
  }
  // Which pixels both see isn't known yet: those that a slow camera would.
  return best_of(observations, candidates, candidates.back(), options);
}

PhotometricState search_nearby(const RoadObservations& observations, const PhotometricState& start,
                               const PlaneOptions& options) {
  std::vector<PhotometricState> candidates{start};
  for (const double pitch_deg : {-2.0, 0.0, 2.0}) {
    for (const double factor : {0.85, 0.9, 0.95, 1.0, 1.05, 1.1, 1.17}) {
      candidates.push_back(tilted(start, pitch_deg * kDegree, factor));
    }
  }
  return best_of(observations, candidates, start, options);
}

Result<Aligned> align_road(const RoadObservations& observations, const PhotometricState& start, FreeParameters free,
                           const NormalPrior& prior, const PlaneOptions& options) {
  Aligned aligned;
  aligned.state = start;
  // The full size twice: the second image is warped anew by what the first time has found.
  for (int step = options.dense.levels; step >= -1; --step) {
    const int size = std::max(0, step);
    PhotometricLevel level(observations, aligned.state, options.dense, size);
    const int needed = std::max(20, options.dense.min_pixels >> (2 * size));
    if (static_cast<int>(level.pixels().size()) < needed) {
      return Error{ErrorCode::kTooFewMatches,
                   fmt::format("{} pixels of the road are in both images, {} needed", level.pixels().size(), needed)};
    }
    level.match_brightness(aligned.state);
    LevelSolver solver(level, free, prior, options);
    const double gain = solver.solve(aligned);
    if (step >= 0) continue;
    constexpr double kMaxGain = 1e-2;
    if (!(gain < kMaxGain)) return Error{ErrorCode::kNotConverged, "the alignment of the road doesn't settle"};
    aligned.sums = level.sums(aligned.state, aligned.sd, options.dense.loss_bound, true);
    aligned.correlation = level.correlation(aligned.state.homography());
    aligned.level.emplace(std::move(level));
  }
  return aligned;
}

Eigen::MatrixXd alignment_covariance(const Aligned& aligned, FreeParameters free, const NormalPrior& prior,
                                     const PlaneOptions& options) {
  GS_CHECK(aligned.level.has_value(), "an alignment that has come to its end");
  const PhotometricLevel& level = *aligned.level;
  const CauchyLoss loss{options.dense.loss_bound};
  const Eigen::MatrixXd basis = basis_of(free, aligned.state);
  Eigen::MatrixXd of_squares = Eigen::MatrixXd::Zero(kPhotometricSize, level.squares());
  const double per_variance = 1.0 / (aligned.sd * aligned.sd);
  for (const RoadPixel& pixel : level.pixels()) {
    const auto error = level.error(pixel, aligned.state);
    if (!error) continue;
    const double counts = pixel.weight * level.factor(pixel);
    const double weight = counts * loss.weight(error->difference / aligned.sd) * per_variance;
    of_squares.col(pixel.square) += weight * error->difference * error->by_state;
  }
  PhotometricMatrix information = aligned.sums.information;
  PhotometricMatrix spread = of_squares * of_squares.transpose();
  const auto squares = static_cast<double>(level.squares());
  spread *= squares / std::max(1.0, squares - static_cast<double>(basis.cols()));
  // The pixels' noise may be less than that of so many road points: in the same unit, so is what the prior stands for.
  const Eigen::Matrix3d of_pixels = information.block<3, 3>(6, 6);
  const double noise = of_pixels.ldlt().solve(Eigen::Matrix3d(spread.block<3, 3>(6, 6))).trace() / 3.0;
  const Eigen::Matrix3d of_prior = prior.hessian(aligned.state.m);
  information.block<3, 3>(6, 6) += of_prior;
  spread.block<3, 3>(6, 6) += noise * of_prior;
  const Eigen::MatrixXd reduced = basis.transpose() * information * basis;
  const Eigen::MatrixXd inverse = reduced.ldlt().solve(Eigen::MatrixXd::Identity(reduced.rows(), reduced.cols()));
  return inverse * (basis.transpose() * spread * basis) * inverse;
}

Result<void> check_alignment(const Aligned& aligned, const PhotometricState& start, const PlaneOptions& options) {
  const Eigen::Vector3d& m = aligned.state.m;
  constexpr double kMaxRatio = 2.0;
  constexpr double kMaxTiltDeg = 15.0;
  const double ratio = m.norm() / start.m.norm();
  const double tilt_deg = std::atan2(m.cross(start.m).norm(), m.dot(start.m)) / kDegree;
  if (!m.allFinite() || !(ratio < kMaxRatio && ratio > 1.0 / kMaxRatio && tilt_deg < kMaxTiltDeg))
    return Error{ErrorCode::kNotGround, "the aligned plane runs away from where it started"};
  if (!(aligned.correlation >= options.dense.min_correlation)) {
    return Error{ErrorCode::kNotGround, fmt::format("the aligned road correlates by {:.2f}, {:.2f} needed",
                                                    aligned.correlation, options.dense.min_correlation)};
  }
  return {};
}

Result<void> check_certainty(const PlaneMeasurement& measurement, const PlaneOptions& options) {
  const Eigen::Vector3d m = measurement.plane.inverse_form();
  const double log_sd = std::sqrt(m.dot(measurement.covariance_of_m * m)) / m.squaredNorm();
  if (measurement.covariance_of_m.allFinite() && log_sd <= options.dense.max_log_sd) return {};
  return Error{ErrorCode::kTooFewMatches,
               fmt::format("too little texture: the height is uncertain by {:.1f} %", 100.0 * log_sd)};
}

void find_points_on_plane(const RoadObservations& observations, const RigidTransform& cam2_from_cam1,
                          double max_error_px, PlaneMeasurement& measurement) {
  const Eigen::Vector3d m = measurement.plane.inverse_form();
  double squares = 0.0;
  for (const Transfer& transfer : transfers_of(observations)) {
    if (transfer.view != 1) continue;
    const auto error = transfer_error(*observations.camera, cam2_from_cam1, m, transfer);
    if (!error || error->forward.norm() > max_error_px || error->backward.norm() > max_error_px) continue;
    if (!measurement.inliers.empty() && measurement.inliers.back() == transfer.point) continue;
    squares += error->forward.squaredNorm();
    measurement.inliers.push_back(transfer.point);
  }
  if (!measurement.inliers.empty())
    measurement.rms_px = std::sqrt(squares / static_cast<double>(measurement.inliers.size()));
}

}  // namespace groundscale
