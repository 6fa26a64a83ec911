#include "groundscale/simulation/material.hpp"

#include <algorithm>
#include <cmath>

#include "groundscale/core/rng.hpp"
#include "groundscale/simulation/noise.hpp"
#include "groundscale/simulation/patterns_internal.hpp"

namespace groundscale {
namespace {

using internal::covered;
using internal::rough;
using internal::tiles;

constexpr int kVariants = 1 << 16;

/// Paint of lane markings: a dashed line on the crest, a line along each edge.
double marking(double along, double across, double footprint, const RoadProfile& profile) {
  constexpr double kHalfLineM = 0.06;
  constexpr double kDashM = 3.0;
  constexpr double kPeriodM = 9.0;
  constexpr double kEdgeM = 0.3;  // from the kerb
  const double in_period = along - kPeriodM * std::floor(along / kPeriodM);
  const double dash = covered(in_period, 0.0, kDashM, footprint) * covered(across, -kHalfLineM, kHalfLineM, footprint);
  const double edge = profile.half_width_m - kEdgeM;
  return dash + covered(std::abs(across), edge - kHalfLineM, edge + kHalfLineM, footprint);
}

/// Mended rectangles: each cell of 6 m by a lane may hold one. Returns -1 to 1 for its tint, 0 outside.
double patch(double along, double across, const RoadLook& road, std::uint64_t seed) {
  constexpr double kCellM = 6.0;
  const double width = road.profile.half_width_m;
  const auto column = static_cast<std::int64_t>(std::floor(along / kCellM));
  const auto row = static_cast<std::int64_t>(std::floor(across / width));
  Rng rng(cell_seed(column, row, seed));
  // Rectangles fill a third of their cell on average.
  constexpr double kFilled = 0.33;
  if (rng.uniform() * kFilled > road.asphalt.patches_share) return 0.0;
  const double length = kCellM * rng.uniform(0.3, 0.9);
  const double breadth = width * rng.uniform(0.3, 0.8);
  const double from = rng.uniform(0.0, kCellM - length);
  const double side = rng.uniform(0.0, width - breadth);
  const double x = along - static_cast<double>(column) * kCellM - from;
  const double y = across - static_cast<double>(row) * width - side;
  const double tint = rng.uniform(-1.0, 0.6);
  return x >= 0.0 && x <= length && y >= 0.0 && y <= breadth ? tint : 0.0;
}

/// Where lines run that dark ones follow: cracks, and the tar that others were sealed with.
struct Lines {
  double spacing_m;
  double width_m;
  double least;        ///< Of a second field of unit sd: they run only here and there.
  double least_per_m;  ///< Wave number of that field.
};

/// 1 on a line, the zero line of a smooth field, averaged over the footprint.
double line(double along, double across, double footprint, const Lines& lines, std::uint64_t seed) {
  if (smooth_noise(along * lines.least_per_m, across * lines.least_per_m, seed + 1) < lines.least) return 0.0;
  // The field's slope is about 1 a spacing: its value is the distance from its zero line.
  const double distance = lines.spacing_m * smooth_noise(along / lines.spacing_m, across / lines.spacing_m, seed);
  return covered(distance, -0.5 * lines.width_m, 0.5 * lines.width_m, footprint);
}

/// Iron lids in the lanes, each in a ring of fresh asphalt: what they take from the asphalt's tone.
double manhole(double along, double across, double footprint, const RoadLook& road, std::uint64_t seed) {
  constexpr double kCellM = 18.0;
  const auto column = static_cast<std::int64_t>(std::floor(along / kCellM));
  Rng rng(cell_seed(column, 0, seed));
  if (rng.uniform() > road.asphalt.manholes_share) return 0.0;
  const double x = along - kCellM * static_cast<double>(column) - rng.uniform(2.0, kCellM - 2.0);
  const double half = road.profile.half_width_m;
  const double radius = std::hypot(x, across - rng.uniform(-0.8 * half, 0.8 * half));
  constexpr double kLidM = 0.32;
  constexpr double kRingM = 0.42;
  return 0.45 * covered(radius, -1.0, kLidM, footprint) + 0.2 * covered(radius, -1.0, kRingM, footprint);
}

double asphalt_albedo(const Eigen::Vector2d& uv, double footprint, bool marked, const RoadLook& road,
                      std::uint64_t seed) {
  const AsphaltOptions& o = road.asphalt;
  const RoadProfile& profile = road.profile;
  const double along = uv.x();
  const double across = uv.y();
  const FractalNoise grain{
      .seed = seed, .longest_m = 0.05, .octaves = 3, .first_sd = 0.55 * o.grain, .persistence = 1.0};
  const FractalNoise stains{
      .seed = seed + 100, .longest_m = 6.0, .octaves = 7, .first_sd = 0.38 * o.stains, .persistence = 1.0};
  double tone = 1.0 + grain.at(along, across, footprint) + stains.at(along, across, footprint);
  // Wheel tracks are polished dark; the gutter is dirty.
  constexpr double kHalfTrackM = 0.75;
  constexpr double kTrackSdM = 0.22;
  const double from_track = std::abs(std::abs(std::abs(across) - profile.lane_offset_m) - kHalfTrackM);
  tone -= 0.06 * std::exp(-0.5 * std::pow(from_track / kTrackSdM, 2));
  tone -= 0.15 * covered(std::abs(across), profile.half_width_m - 0.25, profile.half_width_m + 1.0, footprint);
  tone += 0.18 * patch(along, across, road, seed + 200);
  constexpr Lines kCracks{.spacing_m = 2.5, .width_m = 0.012, .least = 0.8, .least_per_m = 0.2};
  constexpr Lines kSeals{.spacing_m = 4.0, .width_m = 0.06, .least = 0.7, .least_per_m = 0.08};
  tone -= 0.45 * line(along, across, footprint, kCracks, seed + 300);
  // Along the road more than across it.
  tone -= 0.55 * line(0.3 * along, across, footprint, kSeals, seed + 320);
  tone -= manhole(along, across, footprint, road, seed + 350);
  double value = o.albedo * tone;
  const double painted = o.markings && marked ? std::min(1.0, marking(along, across, footprint, profile)) : 0.0;
  if (painted > 0.0) {
    const FractalNoise wear{.seed = seed + 400, .longest_m = 0.4, .octaves = 5, .first_sd = 0.5, .persistence = 0.9};
    const double left = std::clamp(0.5 + 2.0 * (wear.at(along, across, footprint) + 0.5 - o.marking_wear), 0.0, 1.0);
    constexpr double kPaint = 0.55;
    value += painted * left * (kPaint - value);
  }
  return value;
}

}  // namespace

int material_code(Material material, int variant) {
  return static_cast<int>(material) * kVariants + variant % kVariants;
}

double mirrored(int material_code) {
  switch (static_cast<Material>(material_code / kVariants)) {
    case Material::kGlass:
      return 0.12;
    case Material::kPaint:
      return 0.05;
    default:
      return 0.0;
  }
}

bool is_road(int material_code) { return material_code / kVariants == static_cast<int>(Material::kAsphalt); }

double albedo(int material_code, const Eigen::Vector2d& uv, double footprint_m, const RoadLook& road,
              std::uint64_t seed) {
  const auto material = static_cast<Material>(material_code / kVariants);
  const int variant = material_code % kVariants;
  double value = 0.0;
  switch (material) {
    case Material::kAsphalt:
      value = asphalt_albedo(uv, footprint_m, variant == 0, road, seed);
      break;
    case Material::kKerb:
      value = 0.35 * tiles(uv, footprint_m, {.width_m = 1.0, .height_m = 1.0}, seed + 600) *
              rough(uv, footprint_m, {.longest_m = 1.5, .octaves = 6, .sd = 0.15}, seed + 601);
      break;
    case Material::kPavement:
      value = 0.28 * tiles(uv, footprint_m, {.width_m = 0.4, .height_m = 0.4}, seed + 700) *
              rough(uv, footprint_m, {.longest_m = 1.5, .octaves = 6, .sd = 0.15}, seed + 701);
      break;
    case Material::kGrass:
      value = 0.17 * std::max(0.2, rough(uv, footprint_m, {.longest_m = 2.0, .octaves = 7, .sd = 0.4}, seed + 800));
      break;
    default:
      value = internal::object_albedo(material, variant, uv, footprint_m, seed);
      break;
  }
  return std::clamp(value, 0.01, 0.95);
}

}  // namespace groundscale
