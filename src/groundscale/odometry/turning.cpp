#include "groundscale/odometry/turning.hpp"

#include <numbers>

#include "groundscale/geometry/so3.hpp"

namespace groundscale {

double turned_deg(std::span<const RigidTransform> world_from_cam) {
  constexpr double kPieceM = 10.0;
  constexpr double kLeastDeg = 3.0;
  double sum = 0.0;
  std::size_t begin = 0;
  for (std::size_t k = 1; k < world_from_cam.size(); ++k) {
    const RigidTransform from_begin = world_from_cam[begin].inverse() * world_from_cam[k];
    if (from_begin.translation.norm() < kPieceM) continue;
    const double turn_deg = rotation_angle(from_begin.rotation) * 180.0 / std::numbers::pi;
    if (turn_deg >= kLeastDeg) sum += turn_deg;
    begin = k;
  }
  return sum;
}

}  // namespace groundscale
