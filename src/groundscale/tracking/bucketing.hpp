#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace groundscale {

/// Every (n / count)-th of the points in their order, so that those that came in order of a grid stay evenly spread.
std::vector<Eigen::Vector2d> thin_out(const std::vector<Eigen::Vector2d>& points, int count);

/// Some of the candidates, spread over the image: from each cell of a grid the first candidate, then from each the
/// second, and so on; what is taken already counts as chosen before them. Where a round has more than are still wanted,
/// every n-th of its cells.
/// @param candidates  The better ones first.
/// @return Indices, in the order in which they were chosen.
std::vector<std::size_t> pick_evenly(const std::vector<Eigen::Vector2d>& candidates,
                                     const std::vector<Eigen::Vector2d>& taken, int cell_px, int count);

}  // namespace groundscale
