#pragma once

#include "groundscale/core/result.hpp"
#include "groundscale/geometry/trajectory.hpp"

namespace groundscale {

/// Absolute trajectory errors, root mean square distance of the positions in metres.
struct AbsoluteErrors {
  int rows = 0;
  double ate_se3_m = 0.0;   ///< After the best rotation and translation: scale errors count in full.
  double ate_sim3_m = 0.0;  ///< After the best similarity: what is left when the truth has given the scale away.
  double sim3_scale = 1.0;  ///< Factor of that similarity on the estimate; above 1 the estimate is too short.
};

/// Aligns the estimate to the truth in the least-squares sense (Umeyama 1991) and measures what remains.
/// @return kBadInput as compare_steps; kTooFewMatches as align_points (fewer than three rows, an estimate on one spot).
Result<AbsoluteErrors> absolute_errors(const Trajectory& estimate, const Trajectory& truth);

}  // namespace groundscale
