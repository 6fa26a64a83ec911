#include "groundscale/simulation/shapes.hpp"

#include <algorithm>
#include <cmath>

namespace groundscale {

Footing footing(const RoadSurface& surface, double distance_m, double from_crest_m) {
  const PathPoint point = surface.path().at(distance_m);
  Footing footing;
  footing.along = point.forward();
  footing.right = point.right();
  footing.origin = point.position + (from_crest_m - surface.profile().lane_offset_m) * footing.right;
  footing.origin.y() = surface.ground_y(footing.origin.x(), footing.origin.z());
  return footing;
}

bool clear_of_roads(const RoadSurface& surface, const std::vector<Eigen::Vector3d>& places, double clear_m) {
  return std::all_of(places.begin(), places.end(), [&](const Eigen::Vector3d& place) {
    return std::abs(surface.locate(place.x(), place.z()).from_crest_m) >= surface.profile().half_width_m + clear_m;
  });
}

void add_wall(TriangleMesh& mesh, const Eigen::Vector3d& from, const Eigen::Vector3d& to, double bottom_m,
              double top_m) {
  const double length = (to - from).norm();
  const Eigen::Vector3d up = -Eigen::Vector3d::UnitY();
  mesh.add_quad(mesh.add_vertex(from + bottom_m * up, {0.0, bottom_m}),
                mesh.add_vertex(to + bottom_m * up, {length, bottom_m}),
                mesh.add_vertex(to + top_m * up, {length, top_m}), mesh.add_vertex(from + top_m * up, {0.0, top_m}));
}

}  // namespace groundscale
