#include "groundscale/simulation/renderer.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

constexpr double kSkyLight = 0.35;  ///< On level ground, of what the sun gives.
constexpr double kSunLight = 0.9;

/// Sky: brighter towards the horizon.
double sky(const Eigen::Vector3d& direction) {
  const double up = std::max(0.0, -direction.y());
  return 0.75 - 0.3 * std::min(1.0, up * 1.5);
}

struct Sample {
  double radiance = 0.0;
  int surface = -1;  ///< What was met, to tell edges; -1: sky.
};

class Shading {
 public:
  Shading(const World& world, const Camera& camera, const Shutter& shutter, const RenderOptions& options)
      : world_(world),
        camera_(camera),
        options_(options),
        poses_(spread(shutter, options.samples)),
        fine_poses_(spread(shutter, options.edge_samples)),
        sun_(world.sun()) {}

  float pixel(int x, int y) const {
    int surface = -2;
    bool edge = false;
    double sum = 0.0;
    const int side = options_.samples;
    for (int k = 0; k < side * side; ++k) {
      const Sample s = sample(x, y, k, side, poses_);
      sum += s.radiance;
      if (surface != -2 && s.surface != surface) edge = true;
      surface = s.surface;
    }
    if (!edge || options_.edge_samples <= side) return static_cast<float>(sum / (side * side));
    const int fine = options_.edge_samples;
    sum = 0.0;
    for (int k = 0; k < fine * fine; ++k) sum += sample(x, y, k, fine, fine_poses_).radiance;
    return static_cast<float>(sum / (fine * fine));
  }

 private:
  /// A pose for each ray of a pixel, in an order that ties no place in the pixel to early or late.
  static std::vector<RigidTransform> spread(const Shutter& shutter, int side) {
    constexpr int kStride = 7;  // has no factor in common with the powers of two and three that sides are
    const int count = side * side;
    std::vector<RigidTransform> poses;
    for (int k = 0; k < count; ++k) {
      const double share = (k * kStride % count + 0.5) / count;
      poses.push_back(between(shutter.world_from_cam_open, shutter.world_from_cam_close, share));
    }
    return poses;
  }

  Sample sample(int x, int y, int k, int side, const std::vector<RigidTransform>& poses) const {
    const RigidTransform& pose = poses[static_cast<std::size_t>(k)];
    const int column = k % side;
    const int row = k / side;
    const auto ray = camera_.ray({x + (column + 0.5) / side - 0.5, y + (row + 0.5) / side - 0.5});
    if (!ray) return {};
    const Eigen::Vector3d direction = pose.rotation * *ray;
    const auto hit = world_.scene.hit(pose.translation, direction);
    if (!hit) return {sky(direction), -1};
    // Of a pixel's share seen at a slant, the side of a square of the same area.
    const double slant = std::max(0.02, -hit->normal.dot(direction));
    const double footprint = hit->distance_m / (camera_.focal_px() * side) / std::sqrt(slant);
    const double value = albedo(hit->material, hit->uv, footprint, {world_.options.asphalt, world_.options.profile},
                                world_.options.seed);
    const Eigen::Vector3d place = pose.translation + hit->distance_m * direction;
    const double facing = hit->normal.dot(sun_);
    constexpr double kOffM = 2e-3;  // off the surface, against its own roughness in single precision
    const bool lit = facing > 0.0 && !world_.scene.blocked(place + kOffM * hit->normal, sun_);
    // Half of the sky is over a wall, all of it over the ground.
    const double open = 0.5 - 0.5 * hit->normal.y();
    return {value * (kSkyLight * (0.3 + 0.7 * open) + (lit ? kSunLight * facing : 0.0)), hit->mesh};
  }

  const World& world_;
  const Camera& camera_;
  const RenderOptions& options_;
  std::vector<RigidTransform> poses_;
  std::vector<RigidTransform> fine_poses_;
  Eigen::Vector3d sun_;
};

}  // namespace

RigidTransform between(const RigidTransform& from, const RigidTransform& to, double share) {
  const Eigen::Vector3d turn = log_so3(from.rotation.transpose() * to.rotation);
  return {from.rotation * exp_so3(share * turn), from.translation + share * (to.translation - from.translation)};
}

Radiance render(const World& world, const Camera& camera, const Shutter& shutter, const RenderOptions& options) {
  Radiance image{camera.width(), camera.height(), {}};
  image.values.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  const Shading shading(world, camera, shutter, options);
  std::atomic<int> next{0};
  const auto work = [&] {
    for (int y = next++; y < image.height; y = next++) {
      float* row = image.values.data() + static_cast<std::ptrdiff_t>(y) * image.width;
      for (int x = 0; x < image.width; ++x) row[x] = shading.pixel(x, y);
    }
  };
  std::vector<std::jthread> helpers;
  for (int k = 1; k < options.threads; ++k) helpers.emplace_back(work);
  work();
  return image;
}

}  // namespace groundscale
