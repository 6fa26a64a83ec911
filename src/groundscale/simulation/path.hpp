#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Core>

namespace groundscale {

/// A place on a path. The world's axes are those of a level camera at the path's start: x right, y down, z forward.
struct PathPoint {
  double distance_m = 0.0;  ///< Along the path, from its start.
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double heading_rad = 0.0;      ///< Direction of travel seen from above, (sin, cos) in (x, z): to the right of z.
  double curvature_per_m = 0.0;  ///< Change of heading over distance: positive in a right turn.
  double slope = 0.0;            ///< Rise over distance: positive uphill.
  double bank = 0.0;             ///< Fall to the right that the road has besides its crown, over distance.

  /// Unit vectors of the direction of travel and to its right, seen from above (level whatever the slope).
  Eigen::Vector3d forward() const { return {std::sin(heading_rad), 0.0, std::cos(heading_rad)}; }
  Eigen::Vector3d right() const { return {std::cos(heading_rad), 0.0, -std::sin(heading_rad)}; }
};

/// A piece of a path whose curvature changes evenly from where the piece before ended (0 at the start): straight,
/// clothoid or arc.
struct PathPiece {
  double length_m = 0.0;
  double end_curvature_per_m = 0.0;
};

/// A wave in the height of a path.
struct HeightWave {
  double amplitude_m = 0.0;
  double wavelength_m = 0.0;
  double phase_rad = 0.0;
};

/// The line along the road that the vehicle follows; curvature and slope are continuous.
class Path {
 public:
  /// @param pieces  Lengths above 0.
  /// @param waves   Height above the start's level, summed; the sum begins at 0.
  static Path of_pieces(const std::vector<PathPiece>& pieces, const std::vector<HeightWave>& waves);

  /// The path through places given in order, each at least a centimetre from the one before seen from above; straight
  /// from one to the next, its heading, curvature and slope from the neighbours, so places want to be close together.
  /// Of each place only `position` and `bank` are read.
  static Path through(std::vector<PathPoint> places);

  double length_m() const { return points_.back().distance_m; }
  /// The place `distance_m` along the path; beyond either end the path goes on straight.
  PathPoint at(double distance_m) const;

 private:
  std::vector<PathPoint> points_;  ///< At least two, by distance.
};

/// A turn by `angle_rad` (positive to the right) at `radius_m`, led in and out by clothoids of `lead_m` each.
std::vector<PathPiece> turn_pieces(double angle_rad, double radius_m, double lead_m);

}  // namespace groundscale
