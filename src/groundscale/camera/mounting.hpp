#pragma once

#include <optional>

#include <Eigen/Geometry>

namespace groundscale {

/// How the camera sits on the vehicle. Angles as in n = (sin r, cos r cos p, cos r sin p): pitch > 0 looks down,
/// roll > 0 has the camera's right side lower, yaw > 0 looks to the right of the direction of travel.
struct Mounting {
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
  double yaw_rad = 0.0;

  /// Unit normal from the camera down to the road.
  Eigen::Vector3d normal_in_cam() const;

  /// Direction of travel along the road, a unit vector; (-sin y, 0, cos y) for a level camera.
  Eigen::Vector3d forward_in_cam() const;

  /// Direction to the right of the vehicle along the road: normal x forward.
  Eigen::Vector3d right_in_cam() const { return normal_in_cam().cross(forward_in_cam()); }
};

/// Pitch and roll of a road normal in a camera, inverse of Mounting::normal_in_cam.
struct PlaneAngles {
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
};
PlaneAngles plane_angles(const Eigen::Vector3d& normal_in_cam);

}  // namespace groundscale
