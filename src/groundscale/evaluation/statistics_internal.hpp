#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "groundscale/core/check.hpp"

namespace groundscale::internal {

/// Order statistic at p in [0, 1], linear between neighbours: position p (n - 1) of the sorted values.
inline double percentile(std::vector<double> values, double p) {
  GS_CHECK(!values.empty() && p >= 0.0 && p <= 1.0, "a percentile needs values and p in [0, 1]");
  std::sort(values.begin(), values.end());
  const double position = p * static_cast<double>(values.size() - 1);
  const std::size_t below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (position - static_cast<double>(below)) * (values[above] - values[below]);
}

inline double median(std::vector<double> values) { return percentile(std::move(values), 0.5); }

inline double mean(const std::vector<double>& values) {
  GS_CHECK(!values.empty(), "a mean needs values");
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

}  // namespace groundscale::internal
