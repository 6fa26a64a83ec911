#include "groundscale/tracking/bucketing.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace groundscale {
namespace {

/// Every (n / count)-th of n; all of them where they are no more.
std::vector<std::size_t> every_nth(std::size_t n, int count) {
  const std::size_t wanted = std::min(n, static_cast<std::size_t>(std::max(0, count)));
  std::vector<std::size_t> indices;
  for (std::size_t k = 0; k < wanted; ++k) indices.push_back(k * n / wanted);
  return indices;
}

/// A grid over the rectangle that holds some points.
class Cells {
 public:
  Cells(const std::vector<Eigen::Vector2d>& points, int size_px) : size_px_(size_px) {
    Eigen::Vector2d low = points.front();
    Eigen::Vector2d high = low;
    for (const Eigen::Vector2d& point : points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    first_ = place(low);
    size_ = place(high) - first_ + Eigen::Vector2i::Ones();
  }
  std::size_t count() const { return static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()); }
  /// Nothing outside the rectangle.
  std::optional<std::size_t> of(const Eigen::Vector2d& point) const {
    const Eigen::Vector2i at = place(point) - first_;
    if ((at.array() < 0).any() || (at.array() >= size_.array()).any()) return std::nullopt;
    return static_cast<std::size_t>(at.y()) * static_cast<std::size_t>(size_.x()) + static_cast<std::size_t>(at.x());
  }

 private:
  Eigen::Vector2i place(const Eigen::Vector2d& point) const {
    return {static_cast<int>(std::floor(point.x() / size_px_)), static_cast<int>(std::floor(point.y() / size_px_))};
  }
  int size_px_;
  Eigen::Vector2i first_, size_;
};

}  // namespace

std::vector<Eigen::Vector2d> thin_out(const std::vector<Eigen::Vector2d>& points, int count) {
  std::vector<Eigen::Vector2d> some;
  for (const std::size_t k : every_nth(points.size(), count)) some.push_back(points[k]);
  return some;
}

std::vector<std::size_t> pick_evenly(const std::vector<Eigen::Vector2d>& candidates,
                                     const std::vector<Eigen::Vector2d>& taken, int cell_px, int count) {
  if (candidates.empty()) return {};
  const Cells cells(candidates, cell_px);
  std::vector<int> filled(cells.count(), 0);
  for (const Eigen::Vector2d& point : taken) {
    if (const auto cell = cells.of(point)) ++filled[*cell];
  }
  // In which round each comes, and the rounds one after the other, each with its cells in the grid's order.
  struct Entry {
    int round;
    std::size_t cell, candidate;
  };
  std::vector<Entry> entries;
  std::vector<int> sizes;  // of the rounds
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const std::size_t cell = *cells.of(candidates[k]);
    const int round = filled[cell]++;
    entries.push_back({round, cell, k});
    if (static_cast<int>(sizes.size()) <= round) sizes.resize(static_cast<std::size_t>(round) + 1, 0);
    ++sizes[static_cast<std::size_t>(round)];
  }
  int rounds = 0;
  for (int reached = 0; rounds < static_cast<int>(sizes.size()) && reached < count; ++rounds) {
    reached += sizes[static_cast<std::size_t>(rounds)];
  }
  std::erase_if(entries, [rounds](const Entry& entry) { return entry.round >= rounds; });
  std::sort(entries.begin(), entries.end(),
            [](const Entry& a, const Entry& b) { return a.round != b.round ? a.round < b.round : a.cell < b.cell; });
  std::vector<std::size_t> chosen;
  for (std::size_t begin = 0; begin < entries.size();) {
    const auto size = static_cast<std::size_t>(sizes[static_cast<std::size_t>(entries[begin].round)]);
    for (const std::size_t k : every_nth(size, count - static_cast<int>(chosen.size()))) {
      chosen.push_back(entries[begin + k].candidate);
    }
    begin += size;
  }
  return chosen;
}

}  // namespace groundscale
