#pragma once

#include "groundscale/core/rng.hpp"
#include "groundscale/simulation/road_surface.hpp"
#include "groundscale/simulation/roadside.hpp"
#include "groundscale/simulation/shapes.hpp"

namespace groundscale {

enum class CarKind { kSmall, kEstate, kSaloon, kVan };

/// Any of them, small ones most often.
CarKind random_car_kind(Rng& rng);

struct CarSize {
  double length_m = 4.0;
  double half_width_m = 0.87;
  double height_m = 1.45;
};
CarSize car_size(CarKind kind);

/// A car that heads along its footing, about its middle; some 500 triangles in a few meshes.
/// @param variant  Decides its paint and its number plates.
Meshes car_meshes(const Footing& foot, CarKind kind, int variant);

/// A car's place on the ground about (x, z): its four wheels decide how it lies.
Footing car_footing(const RoadSurface& surface, const Eigen::Vector3d& place, double heading_rad);

/// Cars along both kerbs.
void add_parked_cars(Roadside& roadside);

}  // namespace groundscale
