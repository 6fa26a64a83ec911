#pragma once

#include <optional>
#include <string>
#include <vector>

#include "groundscale/evaluation/kitti_errors.hpp"
#include "groundscale/experiments/plot.hpp"
#include "groundscale/geometry/trajectory.hpp"

namespace groundscale {

/// Whose curve it is: how its columns begin in the data, and its title in the picture.
struct CurveName {
  std::string column;
  std::string title;
};

/// A trajectory as it is drawn, in the world in which all of a figure begin alike.
struct PlottedPath {
  CurveName name;
  Trajectory path;
};

/// Errors over the length of segments.
struct PlottedErrors {
  CurveName name;
  std::vector<KittiErrors::OfLength> by_length;
};

/// As seen from its own first pose.
Trajectory from_first_pose(const Trajectory& trajectory);

/// `trajectory-DRIVE`: a drive from above, x to the right and z ahead. @pre paths of one length, at least one.
Plot trajectory_plot(const std::string& drive, const std::vector<PlottedPath>& paths);

enum class PathError { kTranslation, kRotation };
/// `t_rel-DRIVE` or `r_rel-DRIVE`: errors of the end of a segment over its length. A length that nobody has is left
/// out. @pre all have the same lengths.
Plot length_plot(const std::string& drive, PathError error, const std::vector<PlottedErrors>& errors);

}  // namespace groundscale
