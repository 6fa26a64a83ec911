#pragma once

#include "groundscale/core/options.hpp"

namespace groundscale {

/// Which triangulated points a method looks for the ground among.
enum class GroundPoints {
  kAll,   ///< Those of the whole image, and those of the road region.
  kRoad,  ///< Those of the road region.
};

/// How wide the kernel of `triangulation` is.
enum class HeightKernel {
  kMedianDistance,  ///< sigma = median of |X| + |Y| + |Z|, over mu (libviso2).
  kBaseline,        ///< exp(-mu (h_i - h_j)^2) with heights in baselines,
  kCameraHeight,    ///< or in camera heights, as far as these are known from earlier frames.
};

struct TriangulationPlaneOptions {
  GroundPoints points = GroundPoints::kRoad;  ///< kAll is libviso2's.
  double mu = 50.0;
  HeightKernel kernel = HeightKernel::kMedianDistance;
  /// Heights below this share of the median distance can't be the ground's.
  double min_height = 0.01;
};

struct TriangulationRansacOptions {
  GroundPoints points = GroundPoints::kRoad;
  double max_distance = 0.05;    ///< Of a point to the plane, over the plane's height.
  double max_normal_deg = 15.0;  ///< Planes that far off the expected normal aren't tried, where one is given.
  /// Sd of the direction of motion against the plane; 0: it has no part.
  double vanishing_point_sd_deg = 0.1;
};

/// How a homography is decomposed.
enum class DecompositionSolver { kAnalytic, kNumeric };

struct DecompositionOptions {
  DecompositionSolver solver = DecompositionSolver::kAnalytic;
  double max_normal_deg = 15.0;     ///< Against the expected normal, where one is given.
  double max_rotation_deg = 5.0;    ///< Against the given R.
  double max_direction_deg = 30.0;  ///< Against the given t.
};

/// Where the normal of `delaunay` comes from.
enum class DelaunayNormal {
  kExpected,  ///< From the mounting.
  kFitted,    ///< From the vertices of the triangles on the ground, by least squares.
};

struct DelaunayOptions {
  double max_violations = 0.34;  ///< Share of a vertex' edges that may break the order of row and depth.
  double max_normal_deg = 10.0;  ///< A triangle on the ground against the expected normal.
  double min_height = 0.7;       ///< Of a triangle on the ground, over that of the lowest ones.
  double kernel = 0.02;          ///< Sd of the kernel that finds the mode, over the height.
  int window = 5;                ///< Frames, this one among them.
  DelaunayNormal normal = DelaunayNormal::kFitted;
};

void visit_fields(TriangulationPlaneOptions& options, FieldVisitor& visitor);
void visit_fields(TriangulationRansacOptions& options, FieldVisitor& visitor);
void visit_fields(DecompositionOptions& options, FieldVisitor& visitor);
void visit_fields(DelaunayOptions& options, FieldVisitor& visitor);

}  // namespace groundscale
