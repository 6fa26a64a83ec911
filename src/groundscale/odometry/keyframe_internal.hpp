#pragma once

#include <algorithm>

#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {

/// From one frame to another, above 0.
inline double time_between(double earlier_s, double later_s) {
  constexpr double kMinStepTimeS = 1e-3;
  return std::max(kMinStepTimeS, later_s - earlier_s);
}

/// A motion carried out to a share of it, or beyond it: turn and translation apart.
inline RigidTransform share_of(const RigidTransform& motion, double share) {
  return {exp_so3(share * log_so3(motion.rotation)), share * motion.translation};
}

}  // namespace groundscale
