#pragma once

#include <cstdint>
#include <vector>

#include "groundscale/camera/mounting.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/simulation/road_surface.hpp"
#include "groundscale/simulation/route.hpp"

namespace groundscale {

/// A camera on a vehicle, and how its suspension gives.
struct CameraRig {
  double height_m = 1.65;  ///< At rest, perpendicular to the road.
  double pitch_deg = 0.0;  ///< Of the mounting; signs as Mounting's.
  double roll_deg = 0.0;
  double yaw_deg = 0.0;
  double pitch_per_mps2_deg = 0.3;   ///< Nose down when braking, up when speeding up.
  double roll_per_mps2_deg = 0.35;   ///< Outwards in a turn.
  double shake_pitch_sd_deg = 0.12;  ///< Of what the road's roughness does.
  double shake_roll_sd_deg = 0.10;
  double bounce_sd_m = 0.006;

  Mounting mounting() const;
};

void visit_fields(CameraRig& rig, FieldVisitor& visitor);

/// Of the camera when the vehicle stands at a place of the road: the road's own grade and cross-fall, then the
/// mounting.
RigidTransform camera_at_rest(const RoadSurface& surface, double distance_m, const CameraRig& rig);

/// Of the camera at each state of a drive, with what the suspension does. World axes as for paths.
std::vector<RigidTransform> camera_poses(const RoadSurface& surface, const std::vector<VehicleState>& states,
                                         const CameraRig& rig, std::uint64_t seed);

}  // namespace groundscale
