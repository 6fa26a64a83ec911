#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/simulation/ray_scene.hpp"
#include "groundscale/simulation/road_surface.hpp"

namespace groundscale {

using Meshes = std::vector<TriangleMesh>;

/// A frame on the ground: where, and which way is along and to the right.
struct Footing {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d along = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d right = Eigen::Vector3d::UnitX();

  Eigen::Vector3d at(double right_m, double up_m, double along_m) const {
    return origin + right_m * right + along_m * along - up_m * Eigen::Vector3d::UnitY();
  }
};

/// Beside the path, `from_crest_m` to the right of the crest, on the ground.
Footing footing(const RoadSurface& surface, double distance_m, double from_crest_m);

/// Whether no road, of this pass or another, comes nearer than `clear_m` to any of the places.
bool clear_of_roads(const RoadSurface& surface, const std::vector<Eigen::Vector3d>& places, double clear_m);

/// A wall from one ground point to another, uv along it and up.
void add_wall(TriangleMesh& mesh, const Eigen::Vector3d& from, const Eigen::Vector3d& to, double bottom_m,
              double top_m);

}  // namespace groundscale
