#include "groundscale/simulation/camera_rig.hpp"

#include <cmath>
#include <numbers>

#include "groundscale/simulation/noise.hpp"

namespace groundscale {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// Axes of the vehicle in the world, as columns: right, down, forward, pitched and rolled from how the road lies. Signs
/// as Mounting's.
Eigen::Matrix3d vehicle_axes(const RoadSurface& surface, double distance_m, const Mounting& lean) {
  const PathPoint point = surface.path().at(distance_m);
  const Eigen::Vector3d up = -Eigen::Vector3d::UnitY();
  const double offset = surface.profile().lane_offset_m;
  const double fall = offset > 0.0 ? surface.profile().crown : 0.0;  // to the right of the crest
  const Eigen::Vector3d forward = (point.forward() + point.slope * up).normalized();
  const Eigen::Vector3d sideways = point.right() - fall * up;
  const Eigen::Vector3d right = (sideways - sideways.dot(forward) * forward).normalized();
  Eigen::Matrix3d road;
  road << right, forward.cross(right), forward;
  Eigen::Matrix3d vehicle_from_road;
  vehicle_from_road << lean.right_in_cam(), lean.normal_in_cam(), lean.forward_in_cam();
  return road * vehicle_from_road.transpose();
}

RigidTransform pose_of(const RoadSurface& surface, double distance_m, const CameraRig& rig, const Mounting& lean,
                       double bounce_m) {
  const Eigen::Matrix3d vehicle = vehicle_axes(surface, distance_m, lean);
  Eigen::Matrix3d cam_from_vehicle;
  cam_from_vehicle << rig.mounting.right_in_cam(), rig.mounting.normal_in_cam(), rig.mounting.forward_in_cam();
  const Eigen::Vector3d down = vehicle_axes(surface, distance_m, {}).col(1);
  return {vehicle * cam_from_vehicle.transpose(),
          surface.path().at(distance_m).position - (rig.height_m + bounce_m) * down};
}

}  // namespace

RigidTransform camera_at_rest(const RoadSurface& surface, double distance_m, const CameraRig& rig) {
  return pose_of(surface, distance_m, rig, {}, 0.0);
}

std::vector<RigidTransform> camera_poses(const RoadSurface& surface, const std::vector<VehicleState>& states,
                                         const CameraRig& rig, std::uint64_t seed) {
  std::vector<RigidTransform> poses;
  for (const VehicleState& state : states) {
    const double curvature = surface.path().at(state.distance_m).curvature_per_m;
    const double sideways = state.speed_mps * state.speed_mps * curvature;  // towards the right in a right turn
    // The road's roughness is a matter of place, so a standing vehicle doesn't shake; waves of 2 to 8 m are felt.
    const FractalNoise shake{.seed = seed, .longest_m = 4.0, .octaves = 3, .first_sd = 0.7, .persistence = 0.7};
    const double s = state.distance_m;
    Mounting lean;
    lean.pitch_rad = kRadPerDeg * (-rig.pitch_per_mps2_deg * state.acceleration_mps2 +
                                   rig.shake_pitch_sd_deg * shake.at(s, 0.5, 0.0));
    lean.roll_rad = kRadPerDeg * (-rig.roll_per_mps2_deg * sideways + rig.shake_roll_sd_deg * shake.at(s, 100.5, 0.0));
    poses.push_back(pose_of(surface, s, rig, lean, rig.bounce_sd_m * shake.at(s, 200.5, 0.0)));
  }
  return poses;
}

}  // namespace groundscale
