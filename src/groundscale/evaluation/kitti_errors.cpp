#include "groundscale/evaluation/kitti_errors.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "groundscale/evaluation/steps.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

constexpr std::size_t kStartEvery = 10;  // rows, as in the devkit

std::vector<double> path_lengths_m(const Trajectory& trajectory) {
  std::vector<double> lengths_m{0.0};
  for (std::size_t row = 1; row < trajectory.world_from_cam.size(); ++row) {
    const Eigen::Vector3d step =
        trajectory.world_from_cam[row].translation - trajectory.world_from_cam[row - 1].translation;
    lengths_m.push_back(lengths_m.back() + step.norm());
  }
  return lengths_m;
}

RigidTransform start_from_end(const Trajectory& trajectory, std::size_t start, std::size_t end) {
  return trajectory.world_from_cam[start].inverse() * trajectory.world_from_cam[end];
}

/// Sums of the errors of all segments of one length, not yet divided.
SegmentErrors sum_of_length(const Trajectory& estimate, const Trajectory& truth, const std::vector<double>& distance_m,
                            double length_m) {
  SegmentErrors sum;
  for (std::size_t start = 0; start < distance_m.size(); start += kStartEvery) {
    const auto past = std::upper_bound(distance_m.begin() + static_cast<std::ptrdiff_t>(start), distance_m.end(),
                                       distance_m[start] + length_m);
    if (past == distance_m.end()) break;  // the starts that follow have even less before them
    const std::size_t end = static_cast<std::size_t>(past - distance_m.begin());
    const RigidTransform error = start_from_end(estimate, start, end).inverse() * start_from_end(truth, start, end);
    sum.t_rel += error.translation.norm() / length_m;
    sum.r_rel_rad_per_m += rotation_angle(error.rotation) / length_m;
    ++sum.segments;
  }
  return sum;
}

std::optional<SegmentErrors> mean_of(const SegmentErrors& sum) {
  if (sum.segments == 0) return std::nullopt;
  return SegmentErrors{sum.segments, sum.t_rel / sum.segments, sum.r_rel_rad_per_m / sum.segments};
}

}  // namespace

std::vector<double> kitti_lengths_m() { return {100.0, 200.0, 300.0, 400.0, 500.0, 600.0, 700.0, 800.0}; }

Result<KittiErrors> kitti_errors(const Trajectory& estimate, const Trajectory& truth,
                                 const std::vector<double>& lengths_m) {
  if (const auto comparable = check_comparable(estimate, truth); !comparable) return comparable.error();
  for (const double length_m : lengths_m) {
    if (!std::isfinite(length_m) || length_m <= 0.0) {
      return Error{ErrorCode::kBadInput, fmt::format("a segment of {} m: lengths must be positive", length_m)};
    }
  }
  const std::vector<double> distance_m = path_lengths_m(truth);
  KittiErrors errors;
  SegmentErrors total;
  for (const double length_m : lengths_m) {
    const SegmentErrors sum = sum_of_length(estimate, truth, distance_m, length_m);
    errors.by_length.push_back({length_m, mean_of(sum)});
    total.segments += sum.segments;
    total.t_rel += sum.t_rel;
    total.r_rel_rad_per_m += sum.r_rel_rad_per_m;
  }
  errors.all = mean_of(total);
  return errors;
}

}  // namespace groundscale
