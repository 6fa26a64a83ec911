#include "groundscale/odometry/structure.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/geometry/essential.hpp"

namespace groundscale {
namespace {

double parallax_px(const RayPair& pair, const RigidTransform& cam2_from_cam1, double focal_px) {
  return focal_px * (cam2_from_cam1.rotation * pair.ray1).cross(pair.ray2).norm();
}

}  // namespace

std::vector<StructurePoint> triangulate_pair(const std::vector<RayPair>& pairs, const TwoViewMotion& motion,
                                             const RigidTransform& world_from_cam1, double distance, double focal_px,
                                             double min_parallax_px) {
  std::vector<StructurePoint> points;
  for (const int i : motion.inliers) {
    const RayPair& pair = pairs[static_cast<std::size_t>(i)];
    if (parallax_px(pair, motion.cam2_from_cam1, focal_px) < min_parallax_px) continue;
    const RayDepths depths = triangulate_depths(motion.cam2_from_cam1, pair.ray1, pair.ray2);
    points.push_back({pair.id, world_from_cam1 * Eigen::Vector3d(pair.ray1 * (depths.along_ray1 * distance))});
  }
  return points;
}

std::optional<StructureDistance> distance_from_structure(const std::vector<StructurePoint>& known,
                                                         const std::vector<RayPair>& pairs, const TwoViewMotion& motion,
                                                         const Eigen::Vector3d& centre1_in_world, double focal_px,
                                                         double min_parallax_px) {
  std::vector<double> log_distances;
  auto point = known.begin();
  for (const int i : motion.inliers) {
    const RayPair& pair = pairs[static_cast<std::size_t>(i)];
    while (point != known.end() && point->id < pair.id) ++point;
    if (point == known.end()) break;
    if (point->id != pair.id || parallax_px(pair, motion.cam2_from_cam1, focal_px) < min_parallax_px) continue;
    const double depth = triangulate_depths(motion.cam2_from_cam1, pair.ray1, pair.ray2).along_ray1;
    log_distances.push_back(std::log((point->point_in_world - centre1_in_world).norm() / depth));
  }
  constexpr std::size_t kMinPoints = 15;
  if (log_distances.size() < kMinPoints) return std::nullopt;
  const double centre = median(log_distances);
  std::vector<double> deviations;
  for (const double value : log_distances) deviations.push_back(std::abs(value - centre));
  // Sd of a median of n normal numbers: 1.2533 sigma / sqrt(n), sigma = 1.4826 times the median deviation.
  const double sd = 1.2533 * 1.4826 * median(deviations) / std::sqrt(static_cast<double>(log_distances.size()));
  return StructureDistance{std::exp(centre), sd, static_cast<int>(log_distances.size())};
}

}  // namespace groundscale
