#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/mapping/batch_adjustment.hpp"
#include "groundscale/mapping/drive_tracks.hpp"

namespace groundscale {

/// Reprojection errors over the image, by where a point was seen: what a camera model gets wrong is a pattern here,
/// what tracks get wrong by chance is not.
struct ResidualMap {
  struct Cell {
    Eigen::Vector2d sum_px = Eigen::Vector2d::Zero();  ///< Of projected - seen.
    int count = 0;

    Eigen::Vector2d mean_px() const { return count > 0 ? Eigen::Vector2d(sum_px / count) : Eigen::Vector2d::Zero(); }
  };

  int width = 0;  ///< Of the image, px.
  int height = 0;
  int columns = 0;  ///< Of the grid; its cells are about square.
  int rows = 0;
  std::vector<Cell> cells;  ///< Row by row, from the top left.

  const Cell& cell(int column, int row) const { return cells[static_cast<std::size_t>(row * columns + column)]; }
  int count() const;

  /// Takes in the errors of another drive of the same camera, with the same grid.
  ResidualMap& merge(const ResidualMap& other);

  /// sqrt(mean |mean error of a cell|^2), cells by their counts, those with fewer than `least` left out: the part of
  /// the error that is a pattern. NaN where no cell has enough.
  double pattern_px(int least) const;
};

/// Errors of a drive's tracks, each one's point solved from its own sights as for reprojection_errors; those beyond
/// 3 loss_px are left out.
/// @param columns  Of the grid, at least 1.
/// Deterministic. O(sights).
ResidualMap residual_map(const DriveTracks& drive, const std::vector<RigidTransform>& cam_from_world,
                         const Camera& camera, const BatchOptions& options, int columns = 16);

}  // namespace groundscale
