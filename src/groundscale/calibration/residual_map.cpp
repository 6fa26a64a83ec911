#include "groundscale/calibration/residual_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "groundscale/core/check.hpp"
#include "groundscale/mapping/track_point_internal.hpp"

namespace groundscale {
namespace {

ResidualMap empty_map(const Camera& camera, int columns) {
  ResidualMap map;
  map.width = camera.width();
  map.height = camera.height();
  map.columns = columns;
  const double cell_px = static_cast<double>(map.width) / columns;
  map.rows = std::max(1, static_cast<int>(std::lround(map.height / cell_px)));
  map.cells.resize(static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows));
  return map;
}

/// The image begins half a pixel before the centre of its first one.
ResidualMap::Cell& cell_at(ResidualMap& map, const Eigen::Vector2d& pixel) {
  const int column = static_cast<int>((pixel.x() + 0.5) * map.columns / map.width);
  const int row = static_cast<int>((pixel.y() + 0.5) * map.rows / map.height);
  return map.cells[static_cast<std::size_t>(row * map.columns + column)];
}

}  // namespace

int ResidualMap::count() const {
  int sum = 0;
  for (const Cell& cell : cells) sum += cell.count;
  return sum;
}

ResidualMap& ResidualMap::merge(const ResidualMap& other) {
  GS_CHECK(width == other.width && height == other.height && columns == other.columns && rows == other.rows,
           "maps of one image and grid");
  for (std::size_t k = 0; k < cells.size(); ++k) {
    cells[k].sum_px += other.cells[k].sum_px;
    cells[k].count += other.cells[k].count;
  }
  return *this;
}

double ResidualMap::pattern_px(int least) const {
  double squares = 0.0;
  double count = 0.0;
  for (const Cell& cell : cells) {
    if (cell.count < least) continue;
    squares += cell.count * cell.mean_px().squaredNorm();
    count += cell.count;
  }
  return count > 0.0 ? std::sqrt(squares / count) : std::numeric_limits<double>::quiet_NaN();
}

ResidualMap residual_map(const DriveTracks& drive, const std::vector<RigidTransform>& cam_from_world,
                         const Camera& camera, const BatchOptions& options, int columns) {
  GS_CHECK(columns > 0, "a grid of at least one column");
  GS_CHECK(cam_from_world.size() == drive.views.size(), "a pose for each view");
  ResidualMap map = empty_map(camera, columns);
  const double bound = 3.0 * options.loss_px;
  for (const DriveTracks::Track& track : drive.tracks) {
    const auto point = internal::point_of(track, cam_from_world, camera, options);
    if (!point) continue;
    for (const DriveTracks::Sight& sight : track.sights) {
      const auto projected = camera.project(cam_from_world[static_cast<std::size_t>(sight.view)] * *point);
      if (!projected || !camera.contains(sight.pixel)) continue;
      const Eigen::Vector2d error_px = *projected - sight.pixel;
      if (!(error_px.norm() <= bound)) continue;
      ResidualMap::Cell& cell = cell_at(map, sight.pixel);
      cell.sum_px += error_px;
      ++cell.count;
    }
  }
  return map;
}

}  // namespace groundscale
