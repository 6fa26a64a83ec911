#include "groundscale/simulation/renderer.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <thread>
#include <utility>

#include "groundscale/core/check.hpp"

namespace groundscale {
namespace {

constexpr double kSkyLight = 0.35;  ///< On level ground, of what the sun gives.
constexpr double kSunLight = 0.9;
constexpr int kSide = 2;    ///< Rays a side of a pixel.
constexpr int kPacket = 4;  ///< Rays that are traced at once: one for each place of a pixel.

/// Sky: brighter towards the horizon.
double sky(const Eigen::Vector3d& direction) {
  const double up = std::max(0.0, -direction.y());
  return 0.75 - 0.3 * std::min(1.0, up * 1.5);
}

/// The middle of place `k` of `side` x `side` in a pixel.
Eigen::Vector2d place_in_pixel(int x, int y, int k, int side) {
  const int column = k % side;
  const int row = k / side;
  return {x + (column + 0.5) / side - 0.5, y + (row + 0.5) / side - 0.5};
}

/// What stands still and what moves.
struct Scenes {
  const RayScene& still;
  const RayScene* moving = nullptr;

  std::array<std::optional<RayHit>, kPacket> hit(const RayPacket& rays) const {
    auto hits = still.hit(rays);
    if (moving == nullptr) return hits;
    constexpr int kMovingMeshes = 1 << 24;  // told from what stands still
    auto others = moving->hit(rays);
    for (std::size_t k = 0; k < kPacket; ++k) {
      if (!others[k] || (hits[k] && hits[k]->distance_m <= others[k]->distance_m)) continue;
      hits[k] = others[k];
      hits[k]->mesh += kMovingMeshes;
    }
    return hits;
  }

  std::array<bool, kPacket> blocked(const RayPacket& rays) const {
    auto any = still.blocked(rays);
    if (moving == nullptr) return any;
    const auto others = moving->blocked(rays);
    for (std::size_t k = 0; k < kPacket; ++k) any[k] = any[k] || others[k];
    return any;
  }
};

/// Light along the rays of a pixel.
class Shading {
 public:
  Shading(const World& world, const Scenes& scenes, double focal_px)
      : world_(world), scenes_(scenes), focal_px_(focal_px), sun_(world.sun()) {}

  struct Light {
    double sum = 0.0;
    bool edge = false;  ///< The rays met more than one surface.
  };

  /// @param side  Rays a side of the pixel: what one of them stands for is that much smaller.
  Light of(const RayPacket& rays, int side) const {
    const auto hits = scenes_.hit(rays);
    RayPacket to_sun;
    std::array<double, kPacket> facing{};
    constexpr double kOffM = 2e-3;  // off the surface, against its own roughness in single precision
    for (std::size_t k = 0; k < kPacket; ++k) {
      if (!hits[k]) continue;
      facing[k] = hits[k]->normal.dot(sun_);
      to_sun.valid[k] = facing[k] > 0.0;
      to_sun.origin[k] = rays.origin[k] + hits[k]->distance_m * rays.direction[k] + kOffM * hits[k]->normal;
      to_sun.direction[k] = sun_;
    }
    const auto shadow = scenes_.blocked(to_sun);
    Light light;
    const auto surface = [&hits](std::size_t k) { return hits[k] ? hits[k]->mesh : -1; };
    for (std::size_t k = 0; k < kPacket; ++k) {
      if (surface(k) != surface(0)) light.edge = true;
    }
    const Eigen::Vector2d along = side == kSide && !light.edge && hits[0] ? longer_side(hits) : Eigen::Vector2d::Zero();
    for (std::size_t k = 0; k < kPacket; ++k) {
      if (!rays.valid[k]) continue;
      light.sum += hits[k] ? reflected(*hits[k], rays.direction[k], {side, static_cast<int>(k) % side, along},
                                       to_sun.valid[k] && !shadow[k] ? kSunLight * facing[k] : 0.0)
                           : sky(rays.direction[k]);
    }
    return light;
  }

 private:
  /// What a ray stands for.
  struct Share {
    int side = kSide;                                 ///< The pixel has so many rays a side.
    int column = 0;                                   ///< Place of the ray among those.
    Eigen::Vector2d along = Eigen::Vector2d::Zero();  ///< Its longer side on the surface; zero where it isn't known.
  };

  /// The longer side of what a ray of four on one surface stands for, in the surface's coordinates.
  static Eigen::Vector2d longer_side(const std::array<std::optional<RayHit>, kPacket>& hits) {
    const Eigen::Vector2d across = 0.5 * (hits[1]->uv - hits[0]->uv + hits[3]->uv - hits[2]->uv);
    const Eigen::Vector2d down = 0.5 * (hits[2]->uv - hits[0]->uv + hits[3]->uv - hits[1]->uv);
    return across.squaredNorm() > down.squaredNorm() ? across : down;
  }

  /// Albedo averaged over what a ray stands for. At a slant that is long and narrow: what a square of the same area
  /// leaves of waves along it is sampled too thinly, and flickers from frame to frame. So there are places along it, of
  /// which the two rays of a row have every other one.
  double averaged_albedo(const RayHit& hit, const Eigen::Vector3d& direction, const Share& share) const {
    const double slant = std::max(0.02, -hit.normal.dot(direction));
    const double width = hit.distance_m / (focal_px_ * share.side);
    const double length = width / slant;
    const auto at = [&](const Eigen::Vector2d& uv, double footprint) {
      return albedo(hit.material, uv, footprint, {world_.options.asphalt, world_.options.profile}, world_.options.seed);
    };
    constexpr double kSquareOn = 0.7;
    constexpr double kJump = 2.0;  // coordinates that jump from one ray to the next are no measure
    const double measured = share.along.norm();
    if (slant > kSquareOn || measured == 0.0 || measured > kJump * length) return at(hit.uv, std::sqrt(width * length));
    constexpr double kLongFrom = 1.0 / 3.0;
    const int count = slant < kLongFrom ? 2 : 1;
    const double footprint = std::max(width, 0.5 * length / count);
    double sum = 0.0;
    for (int k = 0; k < count; ++k) {
      const double place = (k + 0.25 + 0.5 * share.column) / count - 0.5;
      sum += at(hit.uv + place * share.along, footprint);
    }
    return sum / count;
  }

  double reflected(const RayHit& hit, const Eigen::Vector3d& direction, const Share& share, double sunlight) const {
    const double value = averaged_albedo(hit, direction, share);
    // Half of the sky is over a wall, all of it over the ground.
    const double open = 0.5 - 0.5 * hit.normal.y();
    return value * (kSkyLight * (0.3 + 0.7 * open) + sunlight);
  }

  const World& world_;
  Scenes scenes_;
  double focal_px_;
  Eigen::Vector3d sun_;
};

/// A pose for each ray of a pixel, in an order that ties no place in the pixel to early or late.
std::vector<RigidTransform> spread(const Shutter& shutter, int side) {
  constexpr int kStride = 7;  // has no factor in common with the powers of two that sides are
  const int count = side * side;
  std::vector<RigidTransform> poses;
  for (int k = 0; k < count; ++k) {
    const double share = (k * kStride % count + 0.5) / count;
    poses.push_back(between(shutter.world_from_cam_open, shutter.world_from_cam_close, share));
  }
  return poses;
}

}  // namespace

Renderer::Renderer(const World& world, CameraPtr camera, const RenderOptions& options)
    : world_(world), camera_(std::move(camera)), options_(options) {
  GS_CHECK(options.edge_samples == kSide || options.edge_samples == 2 * kSide, "2 or 4 rays a side");
  rays_.resize(static_cast<std::size_t>(camera_->width()) * static_cast<std::size_t>(camera_->height()) * kPacket,
               Eigen::Vector3f::Zero());
  for_each_row([this](int y) {
    auto* ray = rays_.data() + static_cast<std::ptrdiff_t>(y) * camera_->width() * kPacket;
    for (int x = 0; x < camera_->width(); ++x) {
      for (int k = 0; k < kPacket; ++k, ++ray) {
        if (const auto found = camera_->ray(place_in_pixel(x, y, k, kSide))) *ray = found->cast<float>();
      }
    }
  });
}

/// Rows are dealt out to threads; which thread has which is of no account.
template <class Row>
void Renderer::for_each_row(const Row& row) const {
  std::atomic<int> next{0};
  const auto work = [&] {
    for (int y = next++; y < camera_->height(); y = next++) row(y);
  };
  std::vector<std::jthread> helpers;
  for (int k = 1; k < options_.threads; ++k) helpers.emplace_back(work);
  work();
}

RayPacket Renderer::rays_of(int x, int y, const std::vector<RigidTransform>& poses) const {
  const Eigen::Vector3f* ray = rays_.data() + (static_cast<std::ptrdiff_t>(y) * camera_->width() + x) * kPacket;
  RayPacket rays;
  for (std::size_t k = 0; k < kPacket; ++k) {
    rays.origin[k] = poses[k].translation;
    rays.direction[k] = poses[k].rotation * ray[k].cast<double>();
    rays.valid[k] = !ray[k].isZero();
  }
  return rays;
}

double Renderer::mean_light(const Shutter& shutter, const RayScene* moving) const {
  constexpr int kStride = 8;
  const Shading shading(world_, {world_.scene, moving}, camera_->focal_px());
  const std::vector<RigidTransform> poses = spread(shutter, kSide);
  double sum = 0.0;
  int count = 0;
  for (int y = kStride / 2; y < camera_->height(); y += kStride) {
    for (int x = kStride / 2; x < camera_->width(); x += kStride, ++count) {
      sum += shading.of(rays_of(x, y, poses), kSide).sum / kPacket;
    }
  }
  return count > 0 ? sum / count : 0.0;
}

Radiance Renderer::render(const Shutter& shutter, const RayScene* moving) const {
  Radiance image{camera_->width(), camera_->height(), {}};
  image.values.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  const Shading shading(world_, {world_.scene, moving}, camera_->focal_px());
  const std::vector<RigidTransform> poses = spread(shutter, kSide);
  const std::vector<RigidTransform> fine_poses = spread(shutter, options_.edge_samples);
  const auto fine = [&](int x, int y) {
    const int side = options_.edge_samples;
    double sum = 0.0;
    for (int first = 0; first < side * side; first += kPacket) {
      RayPacket rays;
      for (std::size_t k = 0; k < kPacket; ++k) {
        const int place = first + static_cast<int>(k);
        const RigidTransform& pose = fine_poses[static_cast<std::size_t>(place)];
        const auto ray = camera_->ray(place_in_pixel(x, y, place, side));
        rays.valid[k] = ray.has_value();
        rays.origin[k] = pose.translation;
        rays.direction[k] = pose.rotation * ray.value_or(Eigen::Vector3d::UnitZ());
      }
      sum += shading.of(rays, side).sum;
    }
    return sum / (side * side);
  };
  for_each_row([&](int y) {
    float* row = image.values.data() + static_cast<std::ptrdiff_t>(y) * image.width;
    for (int x = 0; x < image.width; ++x) {
      const auto light = shading.of(rays_of(x, y, poses), kSide);
      const bool more = light.edge && options_.edge_samples > kSide;
      row[x] = static_cast<float>(more ? fine(x, y) : light.sum / kPacket);
    }
  });
  return image;
}

std::optional<RayHit> Renderer::middle_hit(int x, int y, const RigidTransform& world_from_cam,
                                           const RayScene* moving) const {
  const auto ray = camera_->ray({static_cast<double>(x), static_cast<double>(y)});
  if (!ray) return std::nullopt;
  const Eigen::Vector3d direction = world_from_cam.rotation * *ray;
  auto hit = world_.scene.hit(world_from_cam.translation, direction);
  if (moving == nullptr) return hit;
  auto other = moving->hit(world_from_cam.translation, direction);
  return other && (!hit || other->distance_m < hit->distance_m) ? other : hit;
}

std::vector<float> Renderer::depth(const RigidTransform& world_from_cam, const RayScene* moving) const {
  const int width = camera_->width();
  std::vector<float> depths(static_cast<std::size_t>(width) * static_cast<std::size_t>(camera_->height()), 0.0F);
  for_each_row([&](int y) {
    float* row = depths.data() + static_cast<std::ptrdiff_t>(y) * width;
    for (int x = 0; x < width; ++x) {
      const auto hit = middle_hit(x, y, world_from_cam, moving);
      if (!hit) continue;
      const Eigen::Vector3d ray = *camera_->ray({static_cast<double>(x), static_cast<double>(y)});
      row[x] = static_cast<float>(std::max(0.0, hit->distance_m * ray.z()));
    }
  });
  return depths;
}

Image Renderer::road_mask(const RigidTransform& world_from_cam, const RayScene* moving) const {
  Image mask(camera_->width(), camera_->height());
  for_each_row([&](int y) {
    for (int x = 0; x < mask.width(); ++x) {
      const auto hit = middle_hit(x, y, world_from_cam, moving);
      mask.data()[y * mask.width() + x] = hit && is_road(hit->material) ? 255 : 0;
    }
  });
  return mask;
}

}  // namespace groundscale
