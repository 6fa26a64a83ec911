#pragma once

#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/geometry/trajectory.hpp"

namespace groundscale {

/// Which steps count as moving and which as turns. Both are decided on the truth alone.
struct StepRules {
  double min_speed_mps = 2.0;         ///< Moving: faster than this.
  double min_step_m = 0.2;            ///< The same where the truth has no times (2 m/s at 10 Hz).
  double min_turn_rate_degps = 10.0;  ///< Turn: mean yaw rate of at least this.
  double min_turn_step_deg = 1.0;     ///< The same where the truth has no times.
  int turn_window = 5;                ///< Steps that the yaw rate is averaged over, centred, cut at both ends.
};

/// Row k of a trajectory against row k - 1, in the estimate and in the truth.
struct Step {
  double estimated_m = 0.0;
  double true_m = 0.0;
  double true_distance_m = 0.0;  ///< Path of the truth from its first row to this step's end.
  double rotation_error_rad = 0.0;
  bool moving = false;
  bool turn = false;

  double ratio() const { return estimated_m / true_m; }
};

/// Steps 1 ... n - 1 of two trajectories whose rows belong together; element k - 1 is the step that ends at row k.
///
/// The truth's times are used where it has them. Yaw of a step is that of the optical axis, atan2(a_x, a_z) with
/// a = cam1_from_cam2 (0, 0, 1).
/// @return kBadInput for different lengths, fewer than two rows or numbers that are not finite. O(n).
Result<std::vector<Step>> compare_steps(const Trajectory& estimate, const Trajectory& truth,
                                        const StepRules& rules = {});

/// What every comparison of two trajectories asks of them: the errors of compare_steps.
Result<void> check_comparable(const Trajectory& estimate, const Trajectory& truth);

}  // namespace groundscale
