#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "groundscale/simulation/road_surface.hpp"

namespace groundscale {

/// What surfaces of the world are made of. `uv` of their triangles, in metres: distance along and across the road (from
/// its crest) for what lies on the ground; along and up the wall for facades; from the middle for signs and hubs; along
/// from a car's middle and up for paint; a window's are at its pattern; any for the rest.
enum class Material {
  kAsphalt,
  kKerb,
  kPavement,
  kGrass,
  kFacade,
  kWindow,
  kRoof,
  kBark,
  kLeaves,
  kPaint,
  kGlass,
  kRubber,
  kHub,
  kPlate,
  kLamp,
  kSign,
  kMetal,
  kTrim,
  kWood,
  kStone
};

/// A material with a number that tells one house or car from another, as TriangleMesh has it. Asphalt: 0 with lane
/// markings, 1 without.
int material_code(Material material, int variant);

/// Whether a code is that of the roadway.
bool is_road(int material_code);

/// Share of light that a surface mirrors when seen square on.
double mirrored(int material_code);

/// How asphalt is made up; contrasts are standard deviations relative to its albedo.
struct AsphaltOptions {
  double albedo = 0.23;
  double grain = 0.14;          ///< Stones: centimetres.
  double stains = 0.06;         ///< Decimetres to metres.
  double patches_share = 0.08;  ///< Of the road, mended.
  double manholes_share = 0.5;  ///< Of stretches of 18 m that have one.
  double marking_wear = 0.35;   ///< Share of the paint that is gone.
  bool markings = true;
};

/// Asphalt, and the road that it lies on: edge lines, gutters and wheel tracks go by its profile.
struct RoadLook {
  const AsphaltOptions& asphalt;
  const RoadProfile& profile;
};

/// Share of light that a surface sends back, 0 to 1, averaged over a patch of side `footprint_m`.
double albedo(int material_code, const Eigen::Vector2d& uv, double footprint_m, const RoadLook& road,
              std::uint64_t seed);

}  // namespace groundscale
