#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/image.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/geometry/ground_plane.hpp"
#include "groundscale/geometry/rigid_transform.hpp"

namespace groundscale {

/// A strip along the path that lies ahead, in metres on the road.
struct StripOptions {
  double near_m = 4.0;
  double far_m = 22.0;
  double half_width_m = 2.5;
  double turn_far_m =
      12.0;  ///< Where the path has turned by all that it may, the strip ends there, or here if farther.
};

void visit_fields(StripOptions& options, FieldVisitor& visitor);

/// Where the road is looked for.
struct RegionOptions : StripOptions {
  double max_turn_deg = 20.0;  ///< Beyond this turn of the path the strip goes straight on.
  double weight_sd_m = 0.7;    ///< Points count by exp(-u^2 / 2 sd^2), u from the path: roads fall off to their sides.
  std::vector<double> polygon_px;  ///< x, y, x, y, ...: a fixed region of the image instead; its points count the same.
};

void visit_fields(RegionOptions& options, FieldVisitor& visitor);

/// The arc that a vehicle drives on, as its camera sees it now: direction of travel and curvature.
struct DrivenPath {
  Eigen::Vector3d forward_in_cam = Eigen::Vector3d::UnitZ();  ///< Unit tangent along the road at the camera.
  double curvature_per_m = 0.0;                               ///< > 0 turns right (about the normal that points down).
  double max_turn_rad = 0.5;  ///< The arc ends after this turn and the path goes straight on.
  /// Way over which the curvature is expected to change by as much as itself; 0: it stays as it is.
  double steady_m = 0.0;

  /// By how far the vehicle is expected to leave the arc (sd): |curvature| s^3 / (6 steady_m), s = along_m.
  double sd_m(double along_m) const;
};

/// Path ahead of camera 1 from the motion to camera 2: chord and turn of the step in between; for a vehicle that drives
/// forwards or backwards, `forward_in_cam` always points to where the strip lies (along +forward of the mounting).
/// @param metric_cam2_from_cam1  Translation in metres.
/// @param max_turn_deg           Beyond this turn the path goes straight on.
DrivenPath path_of_motion(const RigidTransform& metric_cam2_from_cam1, const Eigen::Vector3d& normal_in_cam,
                          const Eigen::Vector3d& mounting_forward_in_cam, double max_turn_deg);

/// Point of the road at `along_m` of the path's arc and `aside_m` to its right, in the camera.
Eigen::Vector3d point_on_path(const DrivenPath& path, const GroundPlane& metric_road, double along_m, double aside_m);

/// Distance of a point of the road from the path, in metres, positive to its right; the inverse of point_on_path.
/// @param ray  Towards the point, of any length, in the camera.
double offset_from_path(const DrivenPath& path, const GroundPlane& metric_road, const Eigen::Vector3d& ray);

/// Mask (255 inside) of the strip about the path, projected through the camera; empty where none of it is in view. The
/// strip widens by the sd of the path, to twice its width at most.
Image region_mask(const DrivenPath& path, const GroundPlane& metric_road, const Camera& camera,
                  const RegionOptions& options);

/// a and b, pixel by pixel; an empty mask allows everything.
Image intersect_masks(const Image& a, const Image& b);

/// A region where a mask allows it, an empty mask everywhere; unlike two masks, an empty region stays empty.
Image restrict_region(const Image& region, const Image& allowed);

/// Number of pixels that a mask allows.
int mask_area(const Image& mask);

}  // namespace groundscale
