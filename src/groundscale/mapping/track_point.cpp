#include "groundscale/mapping/track_point_internal.hpp"
#include "groundscale/mapping/triangulation.hpp"

namespace groundscale {

std::optional<Eigen::Vector3d> internal::point_of(const DriveTracks::Track& track,
                                                  const std::vector<RigidTransform>& cam_from_world,
                                                  const Camera& camera, const BatchOptions& options) {
  constexpr std::size_t kMinSights = 3;
  if (track.sights.size() < kMinSights) return std::nullopt;
  std::vector<Sight> sights;
  for (const DriveTracks::Sight& sight : track.sights) {
    const auto ray = camera.ray(sight.pixel);
    if (!ray) return std::nullopt;
    sights.push_back({cam_from_world[static_cast<std::size_t>(sight.view)], *ray, sight.pixel});
  }
  TriangulationOptions triangulation;
  triangulation.loss_px = 2.0 * options.loss_px;
  triangulation.min_parallax_rad = options.min_parallax_px / camera.focal_px();
  const auto point = triangulate(sights, camera, triangulation);
  if (!point || point->rms_px > options.max_error_px) return std::nullopt;
  return point->point_in_world;
}

}  // namespace groundscale
