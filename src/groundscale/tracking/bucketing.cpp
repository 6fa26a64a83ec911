#include "groundscale/tracking/bucketing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

namespace groundscale {
namespace {

/// Every (n / count)-th of n; all of them where they are no more.
std::vector<std::size_t> every_nth(std::size_t n, int count) {
  const std::size_t wanted = std::min(n, static_cast<std::size_t>(std::max(0, count)));
  std::vector<std::size_t> indices;
  for (std::size_t k = 0; k < wanted; ++k) indices.push_back(k * n / wanted);
  return indices;
}

}  // namespace

std::vector<Eigen::Vector2d> thin_out(const std::vector<Eigen::Vector2d>& points, int count) {
  std::vector<Eigen::Vector2d> some;
  for (const std::size_t k : every_nth(points.size(), count)) some.push_back(points[k]);
  return some;
}

std::vector<std::size_t> pick_evenly(const std::vector<Eigen::Vector2d>& candidates,
                                     const std::vector<Eigen::Vector2d>& taken, int cell_px, int count) {
  using Cell = std::pair<int, int>;  // row, column
  const auto cell_of = [cell_px](const Eigen::Vector2d& point) {
    return Cell(static_cast<int>(std::floor(point.y() / cell_px)), static_cast<int>(std::floor(point.x() / cell_px)));
  };
  std::map<Cell, std::size_t> filled;
  for (const Eigen::Vector2d& point : taken) ++filled[cell_of(point)];
  // The rounds, each with its cells in the grid's order.
  std::map<std::pair<std::size_t, Cell>, std::size_t> rounds;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const Cell cell = cell_of(candidates[k]);
    rounds.emplace(std::pair(filled[cell]++, cell), k);
  }
  std::vector<std::size_t> chosen;
  for (auto begin = rounds.begin(); begin != rounds.end() && static_cast<int>(chosen.size()) < count;) {
    std::vector<std::size_t> round;
    auto end = begin;
    for (; end != rounds.end() && end->first.first == begin->first.first; ++end) round.push_back(end->second);
    for (const std::size_t k : every_nth(round.size(), count - static_cast<int>(chosen.size()))) {
      chosen.push_back(round[k]);
    }
    begin = end;
  }
  return chosen;
}

}  // namespace groundscale
