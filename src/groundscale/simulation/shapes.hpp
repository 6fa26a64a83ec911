#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/core/rng.hpp"
#include "groundscale/simulation/ray_scene.hpp"

namespace groundscale {

using Meshes = std::vector<TriangleMesh>;

/// A frame that things are built in: where, and which way is along, to the right and up.
struct Footing {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d along = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d right = Eigen::Vector3d::UnitX();
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();

  Eigen::Vector3d at(double right_m, double up_m, double along_m) const {
    return origin + right_m * right + along_m * along + up_m * up;
  }
};

/// From low to high in a Footing's right, up and along.
struct Box {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
};

/// A quad of corners in order around; uv runs from `uv` at the first along the first side, then along the second.
void add_panel(TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& corners,
               const Eigen::Vector2d& uv = Eigen::Vector2d::Zero());

/// A wall from one ground point to another, uv along it and up.
void add_wall(TriangleMesh& mesh, const Eigen::Vector3d& from, const Eigen::Vector3d& to, double bottom_m,
              double top_m);

/// All six sides; 12 triangles.
void add_box(TriangleMesh& mesh, const Footing& foot, const Box& box);

/// A tube that may narrow, open at its ends; uv around and along it.
struct Tube {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
  double from_radius_m = 0.1;
  double to_radius_m = 0.1;
  int sides = 6;
};
void add_tube(TriangleMesh& mesh, const Tube& tube);

/// A disc of `sides` triangles in the plane of two unit vectors; uv in that plane from its middle.
struct Disc {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  Eigen::Vector3d across = Eigen::Vector3d::UnitX();
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();
  double radius_m = 0.3;
  int sides = 10;
};
void add_disc(TriangleMesh& mesh, const Disc& disc);

/// Leaves as small quads, folded along their middle, about a place.
struct LeafLump {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  Eigen::Vector3d radii = Eigen::Vector3d::Ones();  ///< Along world x, y, z.
  int leaves = 25;
  double leaf_m = 0.4;  ///< Half of a quad's diagonal, on average.
};
/// Two triangles a leaf.
void add_leaves(TriangleMesh& mesh, const LeafLump& lump, Rng& rng);

/// An empty mesh of a material_code().
TriangleMesh mesh_of(int material_code);

/// What isn't empty of `parts` goes to `meshes`.
void append(Meshes& meshes, Meshes&& parts);

/// Triangles of all of them.
int triangles_of(const Meshes& meshes);

}  // namespace groundscale
