#include "groundscale/simulation/path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "groundscale/core/check.hpp"

namespace groundscale {
namespace {

constexpr double kSpacingM = 0.05;
constexpr double kPi = std::numbers::pi;

/// The path is level ground seen from above, its height a function of the distance along it.
struct Height {
  double rise_m = 0.0;
  double slope = 0.0;
};

Height height_at(const std::vector<HeightWave>& waves, double distance_m) {
  Height height;
  for (const HeightWave& wave : waves) {
    const double number = 2.0 * kPi / wave.wavelength_m;
    height.rise_m += wave.amplitude_m * (std::sin(number * distance_m + wave.phase_rad) - std::sin(wave.phase_rad));
    height.slope += wave.amplitude_m * number * std::cos(number * distance_m + wave.phase_rad);
  }
  return height;
}

Eigen::Vector3d direction_of(double heading_rad) { return {std::sin(heading_rad), 0.0, std::cos(heading_rad)}; }

double level_distance(const PathPoint& from, const PathPoint& to) {
  return std::hypot(to.position.x() - from.position.x(), to.position.z() - from.position.z());
}

/// The path goes on by less than a sample, or straight on beyond its ends.
PathPoint moved(const PathPoint& point, double by_m, double curvature_per_m) {
  PathPoint next = point;
  next.distance_m += by_m;
  next.heading_rad += curvature_per_m * by_m;
  // The chord of an arc lies halfway between both headings; its shortness is of the order (curvature by)^2 / 24.
  next.position += by_m * direction_of(0.5 * (point.heading_rad + next.heading_rad));
  next.position.y() -= by_m * point.slope;
  return next;
}

}  // namespace

Path Path::through(std::vector<PathPoint> places) {
  GS_CHECK(places.size() >= 2, "a path has two places");
  const std::size_t last = places.size() - 1;
  places.front().distance_m = 0.0;
  for (std::size_t k = 1; k <= last; ++k) {
    const double step = level_distance(places[k - 1], places[k]);
    GS_CHECK(step >= 0.0099, "places on a path lie apart");
    places[k].distance_m = places[k - 1].distance_m + step;
  }
  for (std::size_t k = 0; k <= last; ++k) {
    const PathPoint& before = places[k == 0 ? 0 : k - 1];
    const PathPoint& after = places[std::min(k + 1, last)];
    const Eigen::Vector3d way = after.position - before.position;
    double heading = std::atan2(way.x(), way.z());
    // Without a jump from one turn to the next.
    if (k > 0) heading = places[k - 1].heading_rad + std::remainder(heading - places[k - 1].heading_rad, 2.0 * kPi);
    places[k].heading_rad = heading;
    places[k].slope = -way.y() / (after.distance_m - before.distance_m);
  }
  for (std::size_t k = 1; k < last; ++k) {
    places[k].curvature_per_m =
        (places[k + 1].heading_rad - places[k - 1].heading_rad) / (places[k + 1].distance_m - places[k - 1].distance_m);
  }
  Path path;
  path.points_ = std::move(places);
  return path;
}

Path Path::of_pieces(const std::vector<PathPiece>& pieces, const std::vector<HeightWave>& waves) {
  GS_CHECK(!pieces.empty(), "a path has a piece");
  Path path;
  PathPoint point;
  point.slope = height_at(waves, 0.0).slope;
  path.points_.push_back(point);
  double begin_m = 0.0;
  double begin_curvature = 0.0;
  for (const PathPiece& piece : pieces) {
    GS_CHECK(piece.length_m > 0.0, "a piece has a length");
    const int count = std::max(1, static_cast<int>(std::ceil(piece.length_m / kSpacingM)));
    const double step = piece.length_m / count;
    const double change = (piece.end_curvature_per_m - begin_curvature) / piece.length_m;
    for (int k = 0; k < count; ++k) {
      point = moved(point, step, begin_curvature + change * (k + 0.5) * step);
      point.distance_m = begin_m + (k + 1) * step;
      point.curvature_per_m = begin_curvature + change * (k + 1) * step;
      const Height height = height_at(waves, point.distance_m);
      point.position.y() = -height.rise_m;
      point.slope = height.slope;
      path.points_.push_back(point);
    }
    begin_m += piece.length_m;
    begin_curvature = piece.end_curvature_per_m;
  }
  return path;
}

PathPoint Path::at(double distance_m) const {
  if (distance_m <= 0.0) return moved(points_.front(), distance_m, 0.0);
  if (distance_m >= length_m()) return moved(points_.back(), distance_m - length_m(), 0.0);
  const auto after =
      std::upper_bound(points_.begin(), points_.end(), distance_m,
                       [](double distance, const PathPoint& point) { return distance < point.distance_m; });
  const PathPoint& low = *std::prev(after);
  const PathPoint& high = *after;
  const double share = (distance_m - low.distance_m) / (high.distance_m - low.distance_m);
  PathPoint point;
  point.distance_m = distance_m;
  point.position = low.position + share * (high.position - low.position);
  point.heading_rad = low.heading_rad + share * (high.heading_rad - low.heading_rad);
  point.curvature_per_m = low.curvature_per_m + share * (high.curvature_per_m - low.curvature_per_m);
  point.slope = low.slope + share * (high.slope - low.slope);
  point.bank = low.bank + share * (high.bank - low.bank);
  return point;
}

std::vector<PathPiece> turn_pieces(double angle_rad, double radius_m, double lead_m) {
  const double curvature = std::copysign(1.0 / radius_m, angle_rad);
  // Each clothoid turns by half of what the arc would over its length.
  const double arc_m = std::abs(angle_rad) * radius_m - lead_m;
  GS_CHECK(lead_m > 0.0 && arc_m > 0.0, "clothoids shorter than the turn");
  return {{lead_m, curvature}, {arc_m, curvature}, {lead_m, 0.0}};
}

}  // namespace groundscale
