#include "groundscale/motion/two_view.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/geometry/essential.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/motion/five_point_internal.hpp"

namespace groundscale {
namespace {

struct EssentialProblem {
  using Model = Eigen::Matrix3d;
  static constexpr int kSampleSize = 5;

  const std::vector<RayPair>& pairs;
  double max_error_rad;

  int count() const { return static_cast<int>(pairs.size()); }
  double max_error() const { return max_error_rad; }
  std::vector<Model> fit(std::span<const int> sample) const {
    std::array<RayPair, kSampleSize> chosen;
    for (int k = 0; k < kSampleSize; ++k) chosen[k] = pairs[static_cast<std::size_t>(sample[k])];
    return five_point_essentials(chosen);
  }
  double error(const Model& essential, int item) const {
    const RayPair& pair = pairs[static_cast<std::size_t>(item)];
    return std::abs(epipolar_error_rad(essential, pair.ray1, pair.ray2));
  }
};

/// Of the four motions of an essential matrix the one with most points in front of both cameras.
RigidTransform motion_in_front(const Eigen::Matrix3d& essential, const std::vector<RayPair>& pairs,
                               const std::vector<int>& inliers) {
  RigidTransform best;
  int best_count = -1;
  for (const RigidTransform& candidate : motions_of_essential(essential)) {
    int count = 0;
    for (const int i : inliers) {
      const RayPair& pair = pairs[static_cast<std::size_t>(i)];
      const RayDepths depths = triangulate_depths(candidate, pair.ray1, pair.ray2);
      if (depths.along_ray1 > 0.0 && depths.along_ray2 > 0.0) ++count;
    }
    if (count > best_count) {
      best_count = count;
      best = candidate;
    }
  }
  return best;
}

/// Epipolar error and its derivative by (rotation vector on the left of R, two tangents of t).
struct Residual {
  double error;
  Eigen::Matrix<double, 1, 5> by_motion;
};

Residual residual_of(const RigidTransform& motion, const Eigen::Matrix3d& essential,
                     const Eigen::Matrix<double, 3, 2>& tangents, const RayPair& pair) {
  const Eigen::Vector3d turned = motion.rotation * pair.ray1;
  const Eigen::Vector3d& t = motion.translation;
  const Eigen::Vector3d normal2 = t.cross(turned);
  const Eigen::Vector3d normal1 = essential.transpose() * pair.ray2;
  const double length = std::sqrt(normal1.squaredNorm() + normal2.squaredNorm());
  const double product = pair.ray2.dot(normal2);

  // product = ray2 . (t x R ray1); |normal1|^2 = |t x ray2|^2; |normal2|^2 = |t x R ray1|^2.
  // By the rotation w: d(R ray1) = w x R ray1. By t: d t = tangents b.
  const Eigen::Vector3d ray2_cross_t = pair.ray2.cross(t);
  Eigen::Matrix<double, 1, 5> by_product;
  by_product.head<3>() = turned.cross(ray2_cross_t).transpose();
  by_product.tail<2>() = turned.cross(pair.ray2).transpose() * tangents;
  // Half the derivative of the squared length: normal1 is turned as a whole by a rotation of view 1, its length stays.
  Eigen::Matrix<double, 1, 5> by_half_square;
  by_half_square.head<3>() = (turned.cross(normal2.cross(t))).transpose();
  by_half_square.tail<2>() = (turned.cross(normal2) + pair.ray2.cross(t.cross(pair.ray2))).transpose() * tangents;
  const double cubed = length * length * length;
  return {product / length, by_product / length - by_half_square * (product / cubed)};
}

struct Refined {
  RigidTransform motion;
  Eigen::Matrix<double, 5, 5> information;
};

Refined refine(RigidTransform motion, const std::vector<RayPair>& pairs, const std::vector<int>& chosen,
               double loss_rad) {
  constexpr int kMaxIterations = 20;
  constexpr double kConverged = 1e-9;  // rad
  const CauchyLoss loss{loss_rad};
  Eigen::Matrix<double, 5, 5> information = Eigen::Matrix<double, 5, 5>::Zero();
  const auto cost_of = [&](const RigidTransform& candidate) {
    const Eigen::Matrix3d essential = essential_matrix(candidate);
    double cost = 0.0;
    for (const int i : chosen) {
      const RayPair& pair = pairs[static_cast<std::size_t>(i)];
      cost += loss.rho(epipolar_error_rad(essential, pair.ray1, pair.ray2));
    }
    return cost;
  };
  double cost = cost_of(motion);
  double damping = 1e-4;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const Eigen::Matrix3d essential = essential_matrix(motion);
    const Eigen::Matrix<double, 3, 2> tangents = tangents_of(motion.translation);
    Eigen::Matrix<double, 5, 1> gradient = Eigen::Matrix<double, 5, 1>::Zero();
    information.setZero();
    for (const int i : chosen) {
      const Residual r = residual_of(motion, essential, tangents, pairs[static_cast<std::size_t>(i)]);
      const double weight = loss.weight(r.error);
      information.noalias() += weight * r.by_motion.transpose() * r.by_motion;
      gradient.noalias() += weight * r.error * r.by_motion.transpose();
    }
    bool moved = false;
    for (int attempt = 0; attempt < 5 && !moved; ++attempt, damping *= 10.0) {
      Eigen::Matrix<double, 5, 5> damped = information;
      damped.diagonal() *= 1.0 + damping;
      const Eigen::Matrix<double, 5, 1> step = damped.ldlt().solve(-gradient);
      if (!step.allFinite()) continue;
      RigidTransform next;
      next.rotation = exp_so3(step.head<3>()) * motion.rotation;
      next.translation = (motion.translation + tangents * step.tail<2>()).normalized();
      const double next_cost = cost_of(next);
      if (next_cost > cost) continue;
      moved = true;
      const bool converged = step.norm() < kConverged || cost - next_cost < 1e-9 * cost;
      motion = next;
      cost = next_cost;
      damping = std::max(1e-8, damping * 0.01);
      if (converged) iteration = kMaxIterations;
    }
    if (!moved) break;
  }
  motion.rotation = nearest_rotation(motion.rotation);
  return {motion, information};
}

std::vector<int> inliers_of_motion(const RigidTransform& motion, const std::vector<RayPair>& pairs,
                                   double max_error_rad) {
  const Eigen::Matrix3d essential = essential_matrix(motion);
  std::vector<int> inliers;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (std::abs(epipolar_error_rad(essential, pairs[i].ray1, pairs[i].ray2)) > max_error_rad) continue;
    const RayDepths depths = triangulate_depths(motion, pairs[i].ray1, pairs[i].ray2);
    if (depths.along_ray1 > 0.0 && depths.along_ray2 > 0.0) inliers.push_back(static_cast<int>(i));
  }
  return inliers;
}

TwoViewMotion lost(std::string reason) {
  TwoViewMotion motion;
  motion.reason = std::move(reason);
  return motion;
}

}  // namespace

void visit_fields(MotionOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "max_error_px", .unit = "px", .help = "epipolar error of an inlier", .min = 0.05, .max = 10},
                options.max_error_px);
  visitor.field(
      {.key = "loss_px", .unit = "px", .help = "bound of the Cauchy loss that refines R and t", .min = 0.01, .max = 10},
      options.loss_px);
  visitor.field(
      {.key = "min_inliers", .unit = "", .help = "fewer inliers make the motion lost", .min = 6, .max = 10000},
      options.min_inliers);
  visitor.field({.key = "still_px",
                 .unit = "px",
                 .help = "the camera stands where three quarters of the points move less",
                 .min = 0.0,
                 .max = 5},
                options.still_px);
  visitor.field({.key = "min_parallax_px",
                 .unit = "px",
                 .help = "the camera only turns where three quarters of the points have less parallax",
                 .min = 0.01,
                 .max = 20},
                options.min_parallax_px);
  visitor.group("ransac", options.ransac);
}

std::vector<RayPair> ray_pairs(const Matches& matches, const Camera& camera) {
  std::vector<RayPair> pairs;
  pairs.reserve(matches.size());
  for (const Match& match : matches) {
    const auto ray1 = camera.ray(match.pixel1);
    const auto ray2 = camera.ray(match.pixel2);
    if (ray1 && ray2) pairs.push_back({match.id, *ray1, *ray2});
  }
  return pairs;
}

RotationFit fit_rotation(const std::vector<RayPair>& pairs, double focal_px) {
  RotationFit fit;
  constexpr int kIterations = 10;
  constexpr double kMinLossPx = 0.5;
  std::vector<double> left(pairs.size());
  const auto residuals = [&] {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      left[i] = (pairs[i].ray2 - fit.cam2_from_cam1 * pairs[i].ray1).norm();
    }
  };
  // Reweighted: near points move beside the rotation, far ones tell it.
  for (int k = 0; k < kIterations; ++k) {
    residuals();
    const CauchyLoss loss{std::max(kMinLossPx / focal_px, 0.5 * median(left))};
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const Eigen::Vector3d turned = fit.cam2_from_cam1 * pairs[i].ray1;
      const double weight = loss.weight(left[i]);
      // d(turned) = w x turned, so the normal equations are those of sum |ray2 - turned - w x turned|^2.
      information += weight * (Eigen::Matrix3d::Identity() - turned * turned.transpose());
      gradient += weight * turned.cross(pairs[i].ray2);
    }
    const Eigen::Vector3d step = information.ldlt().solve(gradient);
    if (!step.allFinite()) break;
    fit.cam2_from_cam1 = exp_so3(step) * fit.cam2_from_cam1;
    if (step.norm() < 1e-8) break;
  }
  residuals();
  fit.parallax_px = focal_px * quantile(left, 0.75);
  return fit;
}

bool has_stood_still(const std::vector<RayPair>& pairs, double focal_px, const MotionOptions& options, double share) {
  std::vector<double> moved;
  for (const RayPair& pair : pairs) moved.push_back(focal_px * (pair.ray2 - pair.ray1).norm());
  return !moved.empty() && quantile(moved, share) < options.still_px;
}

TwoViewMotion estimate_motion(const std::vector<RayPair>& pairs, double focal_px, const MotionOptions& options,
                              Rng& rng, const std::optional<RigidTransform>& guess) {
  if (static_cast<int>(pairs.size()) < options.min_inliers) {
    return lost(fmt::format("{} matches, {} needed", pairs.size(), options.min_inliers));
  }
  TwoViewMotion motion;
  if (has_stood_still(pairs, focal_px, options)) {
    motion.state = MotionState::kStill;
    return motion;
  }
  const RotationFit rotation = fit_rotation(pairs, focal_px);
  motion.parallax_px = rotation.parallax_px;
  if (rotation.parallax_px < options.min_parallax_px) {
    motion.state = MotionState::kRotating;
    motion.cam2_from_cam1.rotation = rotation.cam2_from_cam1;
    return motion;
  }

  const double max_error_rad = options.max_error_px / focal_px;
  std::vector<Eigen::Matrix3d> guesses;
  if (guess && guess->translation.norm() > 0.0) guesses.push_back(essential_matrix(*guess));
  const auto found = ransac(EssentialProblem{pairs, max_error_rad}, options.ransac, rng, guesses);
  if (!found) return lost("no motion agrees with the matches");

  motion.cam2_from_cam1 = motion_in_front(found->model, pairs, found->inliers);
  motion.inliers = found->inliers;
  // Twice: the refined motion has more inliers than the sample's.
  Eigen::Matrix<double, 5, 5> information;
  for (int round = 0; round < 2; ++round) {
    const Refined refined = refine(motion.cam2_from_cam1, pairs, motion.inliers, options.loss_px / focal_px);
    motion.cam2_from_cam1 = refined.motion;
    information = refined.information;
    motion.inliers = inliers_of_motion(motion.cam2_from_cam1, pairs, max_error_rad);
    if (static_cast<int>(motion.inliers.size()) < options.min_inliers) {
      return lost(fmt::format("{} of {} matches agree with one motion, {} needed", motion.inliers.size(), pairs.size(),
                              options.min_inliers));
    }
  }
  const Eigen::Matrix3d essential = essential_matrix(motion.cam2_from_cam1);
  double squares = 0.0;
  for (const int i : motion.inliers) {
    const RayPair& pair = pairs[static_cast<std::size_t>(i)];
    const double error = epipolar_error_rad(essential, pair.ray1, pair.ray2);
    squares += error * error;
  }
  const double variance = squares / static_cast<double>(motion.inliers.size());
  motion.rms_px = focal_px * std::sqrt(variance);
  motion.covariance = variance * information.ldlt().solve(Eigen::Matrix<double, 5, 5>::Identity());
  motion.state = MotionState::kMoving;
  return motion;
}

}  // namespace groundscale
