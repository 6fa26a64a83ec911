#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/geometry/rigid_transform.hpp"

namespace groundscale {

/// A point as one view sees it: its pixel and the unit ray of that pixel in the view's camera.
struct Sight {
  RigidTransform cam_from_world;
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

struct TriangulationOptions {
  int max_iterations = 6;
  double loss_px = 1.0;            ///< Cauchy bound.
  double min_parallax_rad = 1e-3;  ///< Nothing comes out below it.
};

void visit_fields(TriangulationOptions& options, FieldVisitor& visitor);

struct TriangulatedPoint {
  Eigen::Vector3d point_in_world = Eigen::Vector3d::Zero();
  /// For noise of 1 px in each coordinate of each pixel; sights beyond three times loss_px don't count.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double parallax_rad = 0.0;  ///< Largest angle at the point between two of the views.
  double rms_px = 0.0;        ///< sqrt(mean |pixel - project(R X + t)|^2) over all sights.
};

/// Point that minimises sum rho(|pixel - project(R X + t)|), rho = Cauchy: Gauss-Newton, with steps shortened where the
/// cost would rise, from the point nearest to all rays.
/// @return Nothing for fewer than two sights, for rays that are parallel within min_parallax_rad, and where the point
///         comes out behind a camera or outside its field.
/// Deterministic. O(iterations * sights + sights^2), without allocation.
std::optional<TriangulatedPoint> triangulate(std::span<const Sight> sights, const Camera& camera,
                                             const TriangulationOptions& options = {});

}  // namespace groundscale
