#pragma once

#include <vector>

#include "groundscale/geometry/rigid_transform.hpp"

namespace groundscale {

/// Poses of one camera along a drive, in metres.
///
/// times_s is empty where nothing is known about time, else as long as world_from_cam and never falling.
struct Trajectory {
  std::vector<RigidTransform> world_from_cam;
  std::vector<double> times_s;

  int size() const { return static_cast<int>(world_from_cam.size()); }
  bool has_times() const { return !times_s.empty(); }
};

}  // namespace groundscale
