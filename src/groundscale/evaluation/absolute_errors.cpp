#include "groundscale/evaluation/absolute_errors.hpp"

#include <cmath>
#include <vector>

#include "groundscale/evaluation/steps.hpp"
#include "groundscale/geometry/similarity.hpp"

namespace groundscale {
namespace {

std::vector<Eigen::Vector3d> positions(const Trajectory& trajectory) {
  std::vector<Eigen::Vector3d> points;
  for (const RigidTransform& pose : trajectory.world_from_cam) points.push_back(pose.translation);
  return points;
}

double rms_distance(const std::vector<Eigen::Vector3d>& source, const std::vector<Eigen::Vector3d>& target,
                    const Similarity& target_from_source) {
  double squares = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) squares += (target[i] - target_from_source * source[i]).squaredNorm();
  return std::sqrt(squares / static_cast<double>(source.size()));
}

}  // namespace

Result<AbsoluteErrors> absolute_errors(const Trajectory& estimate, const Trajectory& truth) {
  if (const auto comparable = check_comparable(estimate, truth); !comparable) return comparable.error();
  const std::vector<Eigen::Vector3d> estimated = positions(estimate);
  const std::vector<Eigen::Vector3d> true_points = positions(truth);
  const auto rigid = align_points(estimated, true_points, false);
  if (!rigid) return rigid.error();
  const auto similar = align_points(estimated, true_points, true);
  if (!similar) return similar.error();
  return AbsoluteErrors{estimate.size(), rms_distance(estimated, true_points, *rigid),
                        rms_distance(estimated, true_points, *similar), similar->scale};
}

}  // namespace groundscale
