#include "groundscale/evaluation/steps.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

bool all_finite(const Trajectory& trajectory) {
  return std::all_of(
      trajectory.world_from_cam.begin(), trajectory.world_from_cam.end(),
      [](const RigidTransform& pose) { return pose.rotation.allFinite() && pose.translation.allFinite(); });
}

RigidTransform cam1_from_cam2(const Trajectory& trajectory, int row) {
  return trajectory.world_from_cam[row - 1].inverse() * trajectory.world_from_cam[row];
}

double yaw_rad(const RigidTransform& motion) { return std::atan2(motion.rotation(0, 2), motion.rotation(2, 2)); }

/// Marks the steps whose mean yaw rate over the window reaches the limit.
void mark_turns(const std::vector<double>& yaws_rad, const Trajectory& truth, const StepRules& rules,
                std::vector<Step>& steps) {
  const int count = static_cast<int>(steps.size());
  const int half = rules.turn_window / 2;
  for (int k = 0; k < count; ++k) {
    const int first = std::max(0, k - half);
    const int last = std::min(count - 1, k + half);
    double yaw_deg = 0.0;
    for (int i = first; i <= last; ++i) yaw_deg += yaws_rad[i] * kDegPerRad;
    const double needed_deg = truth.has_times()
                                  ? rules.min_turn_rate_degps * (truth.times_s[last + 1] - truth.times_s[first])
                                  : rules.min_turn_step_deg * (last - first + 1);
    steps[k].turn = std::abs(yaw_deg) >= needed_deg;
  }
}

}  // namespace

Result<void> check_comparable(const Trajectory& estimate, const Trajectory& truth) {
  if (estimate.size() != truth.size()) {
    return Error{ErrorCode::kBadInput, fmt::format("{} rows of estimate against {} of truth: they must be as many",
                                                   estimate.size(), truth.size())};
  }
  if (estimate.size() < 2) {
    return Error{ErrorCode::kBadInput, fmt::format("{} row(s) to compare, at least 2 are needed", estimate.size())};
  }
  if (!all_finite(estimate)) return Error{ErrorCode::kBadInput, "the estimate holds a number that is not finite"};
  if (!all_finite(truth)) return Error{ErrorCode::kBadInput, "the truth holds a number that is not finite"};
  return {};
}

Result<std::vector<Step>> compare_steps(const Trajectory& estimate, const Trajectory& truth, const StepRules& rules) {
  if (const auto comparable = check_comparable(estimate, truth); !comparable) return comparable.error();
  std::vector<Step> steps;
  std::vector<double> yaws_rad;
  double true_distance_m = 0.0;
  for (int row = 1; row < truth.size(); ++row) {
    const RigidTransform estimated = cam1_from_cam2(estimate, row);
    const RigidTransform true_motion = cam1_from_cam2(truth, row);
    Step step;
    step.estimated_m = estimated.translation.norm();
    step.true_m = true_motion.translation.norm();
    step.true_distance_m = true_distance_m += step.true_m;
    step.rotation_error_rad = rotation_angle(estimated.rotation.transpose() * true_motion.rotation);
    const double needed_m =
        truth.has_times() ? rules.min_speed_mps * (truth.times_s[row] - truth.times_s[row - 1]) : rules.min_step_m;
    step.moving = step.true_m > needed_m;
    steps.push_back(step);
    yaws_rad.push_back(yaw_rad(true_motion));
  }
  mark_turns(yaws_rad, truth, rules, steps);
  return steps;
}

}  // namespace groundscale
