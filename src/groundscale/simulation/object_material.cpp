#include <algorithm>
#include <cmath>
#include <numbers>

#include "groundscale/core/rng.hpp"
#include "groundscale/simulation/noise.hpp"
#include "groundscale/simulation/patterns_internal.hpp"

namespace groundscale::internal {
namespace {

std::int64_t cell_of(double x, double size) { return static_cast<std::int64_t>(std::floor(x / size)); }

double within_cell(double x, double size) { return x - size * std::floor(x / size); }

/// Parallel stripes of a period, `share` of it dark: what they take from 1 at most, averaged over the footprint.
double stripes(double x, double period, double share, double footprint) {
  if (footprint > period) return share;
  return covered(within_cell(x, period), 0.0, share * period, footprint);
}

/// Plaster or brick over a plinth.
double facade(const Eigen::Vector2d& uv, double footprint, int variant, std::uint64_t seed) {
  const double tone = cell_value(variant, 1, seed);
  const bool brick = cell_value(variant, 2, seed) < 0.2;
  const double dirt = rough(uv, footprint, {.longest_m = 3.0, .octaves = 4, .sd = 0.05}, seed + 500);
  double value = 0.0;
  if (brick) {
    const Tiles bricks{.width_m = 0.25, .height_m = 0.075, .joint_m = 0.012, .contrast = 0.25, .bonded = true};
    value = (0.16 + 0.14 * tone) * tiles(uv, footprint, bricks, seed + 510);
  } else {
    constexpr double kGrainM = 0.12;
    value = 0.38 + 0.42 * tone;
    if (footprint < kGrainM) {
      value *= rough(uv, footprint, {.longest_m = kGrainM, .octaves = 2, .sd = 0.035}, seed + 520);
    }
  }
  // Rain and splashes darken the foot of the wall.
  const double plinth = 0.3 + 0.5 * cell_value(variant, 3, seed);
  const double foot = covered(uv.y(), -5.0, plinth, footprint);
  return value * dirt * (1.0 - 0.45 * foot);
}

/// A window or balcony door of about 1.2 m: uv is 2 k + 0 ... 1 across for the k-th one, 0 ... 1 up.
double window(const Eigen::Vector2d& uv, double footprint, int variant, std::uint64_t seed) {
  constexpr double kSizeM = 1.2;
  constexpr double kFrame = 0.05;
  const double spread = footprint / kSizeM;
  const std::int64_t which = cell_of(uv.x(), 2.0);
  const double x = within_cell(uv.x(), 2.0);
  const double y = uv.y();
  const double kind = cell_value(which, variant, seed + 530);
  const double tone = cell_value(which, variant, seed + 531);
  double pane = 0.03 + 0.06 * tone;
  if (kind < 0.3) pane = (0.2 + 0.25 * tone) * (1.0 - 0.4 * stripes(x, 0.12, 0.5, spread));
  double value = pane;
  const bool wood = cell_value(variant, 4, seed) < 0.25;
  const double frame = wood ? 0.18 : 0.7;
  const double inside = covered(x, kFrame, 1.0 - kFrame, spread) * covered(y, kFrame, 1.0 - kFrame, spread) *
                        (1.0 - covered(x, 0.5 - 0.6 * kFrame, 0.5 + 0.6 * kFrame, spread)) *
                        (cell_value(variant, 5, seed) < 0.4 ? 1.0 - covered(y, 0.68, 0.68 + kFrame, spread) : 1.0);
  value = frame + inside * (value - frame);
  if (kind > 0.75) {
    // A roller blind, let down in part.
    const double down = covered(y, 1.0 - tone, 2.0, spread);
    value += down * (0.5 * (1.0 - 0.35 * stripes(y, 0.05, 0.3, spread)) - value);
  }
  return value;
}

/// Dark characters on white, as on number plates and street signs.
double plate(const Eigen::Vector2d& uv, double footprint, std::uint64_t seed) {
  constexpr double kPaper = 0.7;
  constexpr double kInk = 0.05;
  constexpr double kWidthM = 0.055;
  constexpr double kHeightM = 0.11;
  const double u = within_cell(uv.x(), kWidthM);
  const double v = within_cell(uv.y(), kHeightM);
  const double letter = cell_value(cell_of(uv.x(), kWidthM), cell_of(uv.y(), kHeightM), seed + 540);
  if (letter > 0.85) return kPaper;
  // Two strokes out of three or four.
  const double left = covered(u, 0.012, 0.02, footprint) * (letter < 0.6 ? 1.0 : 0.0);
  const double right = covered(u, 0.036, 0.044, footprint) * (letter > 0.25 ? 1.0 : 0.0);
  const double low = covered(v, 0.022, 0.032, footprint) * covered(u, 0.012, 0.044, footprint);
  const double high = covered(v, 0.076, 0.086, footprint) * covered(u, 0.012, 0.044, footprint);
  const double upright = covered(v, 0.022, 0.086, footprint);
  const double ink =
      std::min(1.0, upright * (left + right) + (letter < 0.5 ? low : 0.0) + (letter > 0.15 ? high : 0.0));
  return kPaper + ink * (kInk - kPaper);
}

/// A round traffic sign of radius 0.3 m: uv from its middle.
double sign(const Eigen::Vector2d& uv, double footprint, int variant) {
  const double radius = uv.norm();
  const double ring = covered(radius, 0.22, 0.29, footprint);
  const double symbol = variant % 2 == 0
                            ? covered(uv.y(), -0.05, 0.05, footprint) * covered(uv.x(), -0.16, 0.16, footprint)
                            : covered(uv.x(), -0.04, 0.04, footprint) * covered(uv.y(), -0.15, 0.15, footprint);
  return 0.65 - 0.47 * ring - 0.58 * symbol;
}

/// A car's sheet metal: uv along it from its middle, and up. Doors have seams.
double paint(const Eigen::Vector2d& uv, double footprint, int variant, std::uint64_t seed) {
  const double kind = cell_value(variant, 6, seed);
  const double tone = cell_value(variant, 7, seed);
  double value = 0.12 + 0.15 * tone;  // colours
  if (kind < 0.3)
    value = 0.02 + 0.03 * tone;  // black
  else if (kind < 0.62)
    value = 0.25 + 0.2 * tone;
  else if (kind < 0.78)
    value = 0.7;
  constexpr double kSeamM = 0.012;
  double seams = 0.0;
  if (uv.y() > 0.3 && uv.y() < 1.0) {
    for (const double at : {-1.1, -0.25, 0.85}) seams += covered(uv.x(), at, at + kSeamM, footprint);
  }
  const double sill = covered(uv.y(), -1.0, 0.3, footprint);
  return value * (1.0 - 0.7 * std::min(1.0, seams)) * (1.0 - 0.6 * sill) + 0.01;
}

/// Five spokes: uv from the middle.
double hub(const Eigen::Vector2d& uv, double footprint) {
  constexpr double kMean = 0.3;
  const double radius = uv.norm();
  const double fade = std::clamp(1.0 - footprint / 0.1, 0.0, 1.0);
  const double spoke = radius < 0.05 || std::cos(5.0 * std::atan2(uv.y(), uv.x())) > 0.0 ? 0.5 : 0.08;
  return kMean + fade * (spoke - kMean);
}

/// Leaves that are lit among others in shade, which triangles can't show one by one.
double leaves(const Eigen::Vector2d& uv, double footprint, int variant, std::uint64_t seed) {
  constexpr double kLeafM = 0.05;
  const double tone = 0.1 + 0.08 * cell_value(variant, 8, seed);
  const double clumps = rough(uv, footprint, {.longest_m = 0.6, .octaves = 2, .sd = 0.3}, seed + 550);
  const double each = rough(uv, footprint, {.longest_m = kLeafM, .octaves = 2, .sd = 0.65}, seed + 552) - 1.0;
  return tone * std::max(0.15, clumps + std::clamp(each, -0.7, 0.9));
}

double wood(const Eigen::Vector2d& uv, double footprint, int variant, std::uint64_t seed) {
  constexpr double kBoardM = 0.09;
  const double tone = 0.08 + 0.45 * cell_value(variant, 9, seed);
  const double each = 0.3 * (cell_value(cell_of(uv.y(), kBoardM), variant, seed + 560) - 0.5);
  const double fade = std::clamp(1.0 - footprint / kBoardM, 0.0, 1.0);
  return tone * (1.0 + fade * each) * (1.0 - 0.6 * stripes(uv.y(), kBoardM, 0.2, footprint));
}

double stone(const Eigen::Vector2d& uv, double footprint, int variant, std::uint64_t seed) {
  const double tone = 0.2 + 0.25 * cell_value(variant, 10, seed);
  const Tiles blocks{.width_m = 0.4, .height_m = 0.2, .joint_m = 0.015, .contrast = 0.2, .bonded = true};
  return tone * tiles(uv, footprint, blocks, seed + 570) *
         rough(uv, footprint, {.longest_m = 0.8, .octaves = 4, .sd = 0.1}, seed + 580);
}

}  // namespace

double covered(double x, double low, double high, double footprint) {
  const double half = 0.5 * std::max(footprint, 1e-6);
  return std::clamp((std::min(x + half, high) - std::max(x - half, low)) / (2.0 * half), 0.0, 1.0);
}

double tiles(const Eigen::Vector2d& uv, double footprint, const Tiles& tiles, std::uint64_t seed) {
  const std::int64_t row = cell_of(uv.y(), tiles.height_m);
  const double shifted = uv.x() + (tiles.bonded && row % 2 != 0 ? 0.5 * tiles.width_m : 0.0);
  const double joint = std::max(covered(within_cell(shifted, tiles.width_m), 0.0, tiles.joint_m, footprint),
                                covered(within_cell(uv.y(), tiles.height_m), 0.0, tiles.joint_m, footprint));
  const double fade = std::clamp(1.0 - footprint / std::min(tiles.width_m, tiles.height_m), 0.0, 1.0);
  if (fade <= 0.0) return 1.0 - 0.4 * joint;
  const double each = 2.0 * cell_value(cell_of(shifted, tiles.width_m), row, seed) - 1.0;
  return 1.0 + fade * tiles.contrast * each - 0.4 * joint;
}

double rough(const Eigen::Vector2d& uv, double footprint, const Roughness& roughness, std::uint64_t seed) {
  const FractalNoise noise{.seed = seed,
                           .longest_m = roughness.longest_m,
                           .octaves = roughness.octaves,
                           .first_sd = roughness.sd / std::sqrt(roughness.octaves),
                           .persistence = 1.0};
  return 1.0 + noise.at(uv.x(), uv.y(), footprint);
}

double object_albedo(Material material, int variant, const Eigen::Vector2d& uv, double footprint, std::uint64_t seed) {
  const std::uint64_t own_seed = seed + 7919 * static_cast<std::uint64_t>(variant);
  switch (material) {
    case Material::kFacade:
      return facade(uv, footprint, variant, seed);
    case Material::kWindow:
      return window(uv, footprint, variant, seed);
    case Material::kRoof: {
      const Tiles roof{.width_m = 0.25, .height_m = 0.35, .joint_m = 0.03, .contrast = 0.25};
      return (0.08 + 0.14 * cell_value(variant, 11, seed)) * tiles(uv, footprint, roof, own_seed) *
             rough(uv, footprint, {.longest_m = 1.5, .octaves = 4, .sd = 0.12}, own_seed);
    }
    case Material::kBark:
      return 0.13 * rough(uv, footprint, {.longest_m = 0.3, .octaves = 5, .sd = 0.35}, own_seed);
    case Material::kLeaves:
      return leaves(uv, footprint, variant, seed);
    case Material::kPaint:
      return paint(uv, footprint, variant, seed);
    case Material::kGlass:
      return 0.05;
    case Material::kRubber:
      return 0.025;
    case Material::kHub:
      return hub(uv, footprint);
    case Material::kPlate:
      return plate(uv, footprint, own_seed);
    case Material::kLamp:
      return 0.2 + 0.4 * covered(uv.x(), 0.06, 0.2, footprint);
    case Material::kSign:
      return sign(uv, footprint, variant);
    case Material::kMetal:
      return 0.1 + 0.4 * cell_value(variant, 12, seed);
    case Material::kTrim:
      return 0.3 + 0.45 * cell_value(variant, 13, seed);
    case Material::kWood:
      return wood(uv, footprint, variant, seed);
    case Material::kStone:
      return stone(uv, footprint, variant, seed);
    default:
      return 0.2;
  }
}

}  // namespace groundscale::internal
