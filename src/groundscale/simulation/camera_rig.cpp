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
  const double fall = (offset > 0.0 ? surface.profile().crown : 0.0) + point.bank;  // to the right
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
  const Mounting mounting = rig.mounting();
  cam_from_vehicle << mounting.right_in_cam(), mounting.normal_in_cam(), mounting.forward_in_cam();
  const Eigen::Vector3d down = vehicle_axes(surface, distance_m, {}).col(1);
  return {vehicle * cam_from_vehicle.transpose(),
          surface.path().at(distance_m).position - (rig.height_m + bounce_m) * down};
}

}  // namespace

Mounting CameraRig::mounting() const { return {kRadPerDeg * pitch_deg, kRadPerDeg * roll_deg, kRadPerDeg * yaw_deg}; }

void visit_fields(CameraRig& rig, FieldVisitor& visitor) {
  visitor.field({"height_m", "m", "of the lens above the road, perpendicular to it", 0.1, 100.0}, rig.height_m);
  visitor.field({"pitch_deg", "deg", "of the mounting; above 0: the camera looks down", -60.0, 60.0}, rig.pitch_deg);
  visitor.field({"roll_deg", "deg", "of the mounting; above 0: its right side is lower", -60.0, 60.0}, rig.roll_deg);
  visitor.field({"yaw_deg", "deg", "of the mounting; above 0: it looks to the right", -180.0, 180.0}, rig.yaw_deg);
  visitor.field({"pitch_per_mps2_deg", "deg s^2/m", "nose down when braking, up when speeding up", 0.0, 5.0},
                rig.pitch_per_mps2_deg);
  visitor.field({"roll_per_mps2_deg", "deg s^2/m", "outwards in a turn", 0.0, 5.0}, rig.roll_per_mps2_deg);
  visitor.field({"shake_pitch_sd_deg", "deg", "from the road's roughness", 0.0, 5.0}, rig.shake_pitch_sd_deg);
  visitor.field({"shake_roll_sd_deg", "deg", "from the road's roughness", 0.0, 5.0}, rig.shake_roll_sd_deg);
  visitor.field({"bounce_sd_m", "m", "from the road's roughness", 0.0, 0.2}, rig.bounce_sd_m);
}

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
