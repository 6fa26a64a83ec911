#include "groundscale/simulation/roadside.hpp"

#include <algorithm>
#include <cmath>

#include "groundscale/simulation/cars.hpp"
#include "groundscale/simulation/fronts.hpp"
#include "groundscale/simulation/houses.hpp"
#include "groundscale/simulation/plants.hpp"
#include "groundscale/simulation/street_furniture.hpp"

namespace groundscale {
namespace {

constexpr double kCellM = 8.0;

std::int64_t cell_of(std::int64_t column, std::int64_t row) { return (column << 32) ^ (row & 0xffffffff); }

}  // namespace

bool TakenGround::overlap(const Rectangle& a, const Rectangle& b) {
  const Eigen::Vector2d between = b.middle - a.middle;
  // Apart if they are apart along the direction of any side.
  for (const Eigen::Vector2d& side : {a.along, a.aside, b.along, b.aside}) {
    const double reach = std::abs(side.dot(a.along)) + std::abs(side.dot(a.aside)) + std::abs(side.dot(b.along)) +
                         std::abs(side.dot(b.aside));
    if (std::abs(side.dot(between)) >= reach) return false;
  }
  return true;
}

bool TakenGround::take(const Footing& middle, double half_along_m, double half_aside_m) {
  const auto from_above = [](const Eigen::Vector3d& v) { return Eigen::Vector2d(v.x(), v.z()); };
  const Rectangle rectangle{from_above(middle.origin), half_along_m * from_above(middle.along).normalized(),
                            half_aside_m * from_above(middle.right).normalized()};
  const Eigen::Vector2d reach = rectangle.along.cwiseAbs() + rectangle.aside.cwiseAbs();
  const auto cell = [](double place_m) { return static_cast<std::int64_t>(std::floor(place_m / kCellM)); };
  std::vector<std::int64_t> cells;
  for (std::int64_t i = cell(rectangle.middle.x() - reach.x()); i <= cell(rectangle.middle.x() + reach.x()); ++i) {
    for (std::int64_t j = cell(rectangle.middle.y() - reach.y()); j <= cell(rectangle.middle.y() + reach.y()); ++j) {
      cells.push_back(cell_of(i, j));
    }
  }
  for (const std::int64_t key : cells) {
    const auto found = cells_.find(key);
    if (found == cells_.end()) continue;
    for (const int k : found->second) {
      if (overlap(rectangle, rectangles_[static_cast<std::size_t>(k)])) return false;
    }
  }
  for (const std::int64_t key : cells) cells_[key].push_back(static_cast<int>(rectangles_.size()));
  rectangles_.push_back(rectangle);
  return true;
}

Footing Roadside::footing(double distance_m, double from_crest_m) const {
  const PathPoint point = path.at(distance_m);
  Footing footing;
  footing.along = point.forward();
  footing.right = point.right();
  footing.origin = point.position + (from_crest_m - surface.profile().lane_offset_m) * footing.right;
  footing.origin.y() = surface.ground_y(footing.origin.x(), footing.origin.z());
  return footing;
}

double Roadside::pavement_end_m() const {
  const RoadProfile& profile = surface.profile();
  return profile.half_width_m + profile.kerb_width_m + profile.pavement_m;
}

bool Roadside::clear_of_roads(const std::vector<Eigen::Vector3d>& places, double clear_m) const {
  return std::all_of(places.begin(), places.end(), [&](const Eigen::Vector3d& place) {
    return std::abs(surface.locate(place.x(), place.z()).from_crest_m) >= surface.profile().half_width_m + clear_m;
  });
}

void add_roadside(Roadside& roadside) {
  const std::vector<Lot> lots = lay_out_lots(roadside);
  add_houses(roadside, lots);
  add_fronts(roadside, lots);
  add_trees(roadside);
  add_poles(roadside);
  add_boxes(roadside);
  add_parked_cars(roadside);
  add_bushes(roadside);
}

}  // namespace groundscale
