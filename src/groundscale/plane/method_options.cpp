#include "groundscale/plane/method_options.hpp"

namespace groundscale {

template <>
std::vector<std::string_view> names_of<GroundPoints>() {
  return {"all", "road"};
}

template <>
std::vector<std::string_view> names_of<HeightKernel>() {
  return {"median_distance", "baseline", "camera_height"};
}

template <>
std::vector<std::string_view> names_of<DecompositionSolver>() {
  return {"analytic", "numeric"};
}

template <>
std::vector<std::string_view> names_of<DelaunayNormal>() {
  return {"expected", "fitted"};
}

void visit_fields(TriangulationPlaneOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "points", .unit = "", .help = "points that vote for a height; libviso2 takes all"},
                options.points);
  visitor.field({.key = "mu", .unit = "", .help = "how narrow the kernel of the vote is", .min = 1, .max = 10000},
                options.mu);
  visitor.field({.key = "kernel",
                 .unit = "",
                 .help = "sigma is the median distance over mu (libviso2), or the exponent is mu times the squared "
                         "difference in baselines or in camera heights"},
                options.kernel);
  visitor.field({.key = "min_height",
                 .unit = "",
                 .help = "smallest height of the ground, over the median distance",
                 .min = 0,
                 .max = 1},
                options.min_height);
}

void visit_fields(TriangulationRansacOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "points", .unit = "", .help = "points that the plane is laid through"}, options.points);
  visitor.field({.key = "max_distance",
                 .unit = "",
                 .help = "of a point to its plane, over the height of the camera",
                 .min = 0.001,
                 .max = 1},
                options.max_distance);
  visitor.field({.key = "max_normal_deg",
                 .unit = "deg",
                 .help = "the plane against the expected normal, 0: free",
                 .min = 0,
                 .max = 90},
                options.max_normal_deg);
  visitor.field({.key = "vanishing_point_sd_deg",
                 .unit = "deg",
                 .help = "sd of the direction of motion against the road, 0: not used",
                 .min = 0,
                 .max = 45},
                options.vanishing_point_sd_deg);
}

void visit_fields(DecompositionOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "solver",
                 .unit = "",
                 .help = "analytic: Malis and Vargas 2007, numeric: Faugeras and Lustman 1988 (SVD)"},
                options.solver);
  visitor.field({.key = "max_normal_deg",
                 .unit = "deg",
                 .help = "the plane against the expected normal, where one is given",
                 .min = 0.1,
                 .max = 90},
                options.max_normal_deg);
  visitor.field({.key = "max_rotation_deg",
                 .unit = "deg",
                 .help = "the homography's rotation against that of the whole image",
                 .min = 0.01,
                 .max = 180},
                options.max_rotation_deg);
  visitor.field({.key = "max_direction_deg",
                 .unit = "deg",
                 .help = "the homography's direction of motion against that of the whole image",
                 .min = 0.01,
                 .max = 90},
                options.max_direction_deg);
}

void visit_fields(DelaunayOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "max_violations",
                 .unit = "",
                 .help = "share of a vertex' edges that may break the order of row and depth",
                 .min = 0,
                 .max = 1},
                options.max_violations);
  visitor.field({.key = "max_normal_deg",
                 .unit = "deg",
                 .help = "triangles on the ground against the expected normal",
                 .min = 0.5,
                 .max = 90},
                options.max_normal_deg);
  visitor.field({.key = "min_height",
                 .unit = "",
                 .help = "triangles on the ground lie this low, over the lowest ones",
                 .min = 0,
                 .max = 1},
                options.min_height);
  visitor.field(
      {.key = "kernel", .unit = "", .help = "sd of the vote for a height, over the height", .min = 0.001, .max = 1},
      options.kernel);
  visitor.field({.key = "window",
                 .unit = "",
                 .help = "frames that vote together, the present one among them",
                 .min = 1,
                 .max = 100},
                options.window);
  visitor.field({.key = "normal",
                 .unit = "",
                 .help = "of the plane: expected from the mounting, or fitted to the ground's vertices"},
                options.normal);
}

}  // namespace groundscale
