#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/image.hpp"
#include "groundscale/geometry/ground_plane.hpp"
#include "groundscale/geometry/rigid_transform.hpp"

namespace groundscale {

/// One sight of a road point.
struct RoadSight {
  int view = 0;  ///< Index into RoadObservations::cam_from_reference.
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

/// A point on (what is taken for) the road, seen in the reference view and in others.
struct RoadPoint {
  std::int64_t id = 0;
  Eigen::Vector2d pixel_in_reference = Eigen::Vector2d::Zero();
  std::vector<RoadSight> sights;  ///< In other views than the reference.
  double weight = 1.0;            ///< How much it counts, above 0: points beside the driven path lie lower than it.
};

/// A point of the scene, on the road or not, seen in the reference view and in view 1.
struct ScenePoint {
  Eigen::Vector2d pixel_in_reference = Eigen::Vector2d::Zero();
  Eigen::Vector2d pixel_in_view1 = Eigen::Vector2d::Zero();
};

/// What any method estimates the plane from. Two views from the pairwise odometry, many from a SLAM system's map; the
/// unit of all translations is the caller's, and the plane's height comes out in it.
struct RoadObservations {
  CameraPtr camera;
  /// Poses of the views by the reference view, which is view 0 and the identity.
  std::vector<RigidTransform> cam_from_reference;
  std::vector<RoadPoint> points;
  /// Where the normal is expected in the reference view, a unit vector; zero where nothing is known. Used with
  /// PlaneOptions::normal_prior_deg.
  Eigen::Vector3d expected_normal = Eigen::Vector3d::Zero();
  double normal_prior_factor = 1.0;  ///< By how much less is known of it than usual: on the prior's sd.
  /// Where a vehicle drives, along its road, in the reference view: a unit vector; zero where nothing is known. Used
  /// with PlaneOptions::direction_prior_deg.
  Eigen::Vector3d driving_direction = Eigen::Vector3d::Zero();
  /// The plane as earlier frames let it be expected, or a coarse search where they don't, in the unit of the
  /// translations: where a method that only looks nearby starts.
  std::optional<GroundPlane> predicted_plane{};
  /// Covariance of (rotation vector left of R, two tangents of t) of view 1 where it is known, else zero.
  Eigen::Matrix<double, 5, 5> motion_covariance = Eigen::Matrix<double, 5, 5>::Zero();

  /// Points of the whole image that agree with the motion of view 1, for methods that find the ground themselves.
  std::vector<ScenePoint> scene{};
  /// Pixels, for methods that need them: an image a view, or none; and where the road is in that of the reference
  /// view (not 0).
  std::vector<Image> images{};
  Image region{};
  /// How much what lies along a ray of the reference view counts, as RoadPoint::weight; nothing: all the same.
  std::function<double(const Eigen::Vector3d& ray)> weight_of_ray{};
};

}  // namespace groundscale
