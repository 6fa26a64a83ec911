#include "groundscale/simulation/camera_motion.hpp"

#include <algorithm>

#include "groundscale/core/check.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {

RigidTransform between(const RigidTransform& from, const RigidTransform& to, double share) {
  const Eigen::Vector3d turn = log_so3(from.rotation.transpose() * to.rotation);
  return {from.rotation * exp_so3(share * turn), from.translation + share * (to.translation - from.translation)};
}

std::vector<CameraMoment> moments_of_route(const RoadSurface& surface, const Route& route, const CameraRig& rig,
                                           double rate_hz, double shutter_s, std::uint64_t seed) {
  const std::vector<VehicleState> states = drive(route, rate_hz, {});
  const auto poses_after = [&](double by_s) {
    std::vector<VehicleState> moved = states;
    for (VehicleState& state : moved) state.distance_m += by_s * state.speed_mps;
    return camera_poses(surface, moved, rig, seed);
  };
  const auto poses = poses_after(0.0);
  const auto open = poses_after(-0.5 * shutter_s);
  const auto close = poses_after(0.5 * shutter_s);
  std::vector<CameraMoment> moments;
  for (std::size_t k = 0; k < states.size(); ++k) {
    moments.push_back(
        {states[k].time_s, states[k].distance_m, states[k].speed_mps, poses[k], Shutter{open[k], close[k]}});
  }
  return moments;
}

std::vector<CameraMoment> moments_of_laid_road(const LaidRoad& road, const std::vector<double>& times_s,
                                               double shutter_s) {
  const std::size_t count = road.world_from_cam.size();
  GS_CHECK(times_s.size() == count && road.distance_m.size() == count && count >= 2, "a time and a distance a pose");
  std::vector<CameraMoment> moments;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t before = k == 0 ? 0 : k - 1;
    const std::size_t after = std::min(k + 1, count - 1);
    const double interval_s = times_s[after] - times_s[before];
    GS_CHECK(interval_s > 0.0, "times rise");
    const double way = (road.world_from_cam[after].translation - road.world_from_cam[before].translation).norm();
    CameraMoment moment{times_s[k], road.distance_m[k], way / interval_s, road.world_from_cam[k], {}};
    // As fast as from the frame before to the one after.
    const RigidTransform motion =
        moment.world_from_cam.inverse() * between(road.world_from_cam[before], road.world_from_cam[after], 0.5);
    const double share = 0.5 * shutter_s / interval_s;
    const RigidTransform open = between(road.world_from_cam[before], road.world_from_cam[after], 0.5 - share);
    const RigidTransform close = between(road.world_from_cam[before], road.world_from_cam[after], 0.5 + share);
    moment.shutter = {open * motion.inverse(), close * motion.inverse()};
    moments.push_back(moment);
  }
  return moments;
}

}  // namespace groundscale
