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

constexpr double kSkyLight = 0.3;  ///< On level ground, of what the sun gives.
constexpr double kSunLight = 1.1;
constexpr int kSide = 2;    ///< Rays a side of a pixel.
constexpr int kPacket = 4;  ///< Rays that are traced at once: one for each place of a pixel.

/// Sky: brighter towards the horizon.
double sky(const Eigen::Vector3d& direction) {
  const double up = std::max(0.0, -direction.y());
  return 0.75 - 0.3 * std::min(1.0, up * 1.5);
}

/// The middle of one of the 2 x 2 places of a pixel.
Eigen::Vector2d place_in_pixel(int x, int y, int k) {
  const int column = k % kSide;
  const int row = k / kSide;
  return {x + (column + 0.5) / kSide - 0.5, y + (row + 0.5) / kSide - 0.5};
}

/// Places of more rays in a pixel, about its middle: no two in the same column or row.
Eigen::Vector2d place_at_edge(int k, int count) {
  constexpr int kStride = 3;  // has no factor in common with powers of two
  return {(k + 0.5) / count - 0.5, ((k * kStride + 1) % count + 0.5) / count - 0.5};
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
    double sum = 0.0;   ///< Over the four rays.
    bool edge = false;  ///< They met more than one surface.
    bool whole = true;  ///< Each place has a ray.
  };

  /// @param share  Share of a pixel's side that a ray stands for.
  Light of(const RayPacket& rays, double share) const {
    const auto hits = scenes_.hit(rays);
    Light light;
    const auto surface = [&hits](std::size_t k) { return hits[k] ? hits[k]->mesh : -1; };
    for (std::size_t k = 0; k < kPacket; ++k) {
      light.edge = light.edge || surface(k) != surface(0);
      light.whole = light.whole && rays.valid[k];
    }
    const auto sunlight = sunlight_at(rays, hits);
    const auto shared = light.edge || !hits[0] ? std::nullopt : albedo_of_pixel(hits, rays.direction[0]);
    for (std::size_t k = 0; k < kPacket; ++k) {
      if (!rays.valid[k]) continue;
      if (!hits[k]) {
        light.sum += sky(rays.direction[k]);
        continue;
      }
      const double value = shared ? *shared : albedo_of_ray(*hits[k], rays.direction[k], share);
      // Half of the sky is over a wall, all of it over the ground.
      const double open = 0.5 - 0.5 * hits[k]->normal.y();
      light.sum += value * (kSkyLight * (0.3 + 0.7 * open) + sunlight[k]) + glint(*hits[k], rays.direction[k]);
    }
    return light;
  }

 private:
  std::array<double, kPacket> sunlight_at(const RayPacket& rays,
                                          const std::array<std::optional<RayHit>, kPacket>& hits) const {
    RayPacket to_sun;
    std::array<double, kPacket> light{};
    constexpr double kOffM = 2e-3;  // off the surface, against its own roughness in single precision
    for (std::size_t k = 0; k < kPacket; ++k) {
      const double facing = hits[k] ? hits[k]->normal.dot(sun_) : 0.0;
      if (facing <= 0.0) continue;
      light[k] = kSunLight * facing;
      to_sun.valid[k] = true;
      to_sun.origin[k] = rays.origin[k] + hits[k]->distance_m * rays.direction[k] + kOffM * hits[k]->normal;
      to_sun.direction[k] = sun_;
    }
    const auto shadow = scenes_.blocked(to_sun);
    for (std::size_t k = 0; k < kPacket; ++k) light[k] = shadow[k] ? 0.0 : light[k];
    return light;
  }

  double albedo_at(int material, const Eigen::Vector2d& uv, double footprint) const {
    return albedo(material, uv, footprint, {world_.options.asphalt, world_.options.profile}, world_.options.seed);
  }

  /// Over a square of the area that a ray stands for.
  double albedo_of_ray(const RayHit& hit, const Eigen::Vector3d& direction, double share) const {
    const double slant = std::max(0.02, -hit.normal.dot(direction));
    return albedo_at(hit.material, hit.uv, share * hit.distance_m / focal_px_ / std::sqrt(slant));
  }

  /// Over a pixel on one surface. At a slant it is long and narrow: a square of the same area would leave waves along
  /// it that are sampled too thinly, and what is seen would not lie where it is. So there are places along it.
  /// @return Nothing where the surface's coordinates jump between the rays.
  std::optional<double> albedo_of_pixel(const std::array<std::optional<RayHit>, kPacket>& hits,
                                        const Eigen::Vector3d& direction) const {
    // The rays lie half of a pixel apart.
    const Eigen::Vector2d across = hits[1]->uv - hits[0]->uv + hits[3]->uv - hits[2]->uv;
    const Eigen::Vector2d down = hits[2]->uv - hits[0]->uv + hits[3]->uv - hits[1]->uv;
    const Eigen::Vector2d& along = across.squaredNorm() > down.squaredNorm() ? across : down;
    const double slant = std::max(0.02, -hits[0]->normal.dot(direction));
    const double width = hits[0]->distance_m / focal_px_;
    const double length = along.norm();
    constexpr double kJump = 2.5;
    if (length > kJump * width / slant) return std::nullopt;
    constexpr double kMostPlaces = 4.0;
    const auto count = static_cast<int>(std::clamp(std::round(length / width), 1.0, kMostPlaces));
    const double footprint = std::max(width, length / count);
    const Eigen::Vector2d middle = 0.25 * (hits[0]->uv + hits[1]->uv + hits[2]->uv + hits[3]->uv);
    double sum = 0.0;
    for (int k = 0; k < count; ++k) {
      sum += albedo_at(hits[0]->material, middle + ((k + 0.5) / count - 0.5) * along, footprint);
    }
    return sum / count;
  }

  /// What of the sky a smooth surface mirrors (Schlick 1994); below the horizon it mirrors a street in shade.
  static double glint(const RayHit& hit, const Eigen::Vector3d& direction) {
    const double square_on = mirrored(hit.material);
    if (square_on == 0.0) return 0.0;
    constexpr double kStreet = 0.08;
    const double facing = std::clamp(-hit.normal.dot(direction), 0.0, 1.0);
    const double share = square_on + (1.0 - square_on) * std::pow(1.0 - facing, 5);
    const Eigen::Vector3d onward = direction + 2.0 * facing * hit.normal;
    return share * (onward.y() < 0.0 ? sky(onward) : kStreet);
  }

  const World& world_;
  Scenes scenes_;
  double focal_px_;
  Eigen::Vector3d sun_;
};

/// A pose for each of some rays, spread over the time that the shutter is open.
std::vector<RigidTransform> spread(const Shutter& shutter, int count) {
  std::vector<RigidTransform> poses;
  for (int k = 0; k < count; ++k) {
    poses.push_back(between(shutter.world_from_cam_open, shutter.world_from_cam_close, (k + 0.5) / count));
  }
  return poses;
}

/// Ray at a place of a pixel, from those of its 2 x 2 places: straight between them is good to a millionth of a pixel.
Eigen::Vector3d ray_between(const Eigen::Vector3f* rays, const Eigen::Vector2d& place) {
  const auto x = static_cast<float>(2.0 * place.x() + 0.5);
  const auto y = static_cast<float>(2.0 * place.y() + 0.5);
  const Eigen::Vector3f ray =
      (1.0F - y) * ((1.0F - x) * rays[0] + x * rays[1]) + y * ((1.0F - x) * rays[2] + x * rays[3]);
  return ray.cast<double>().normalized();
}

}  // namespace

Renderer::Renderer(const World& world, CameraPtr camera, const RenderOptions& options)
    : world_(world), camera_(std::move(camera)), options_(options) {
  GS_CHECK(options.edge_rays == 0 || options.edge_rays == 8 || options.edge_rays == 16, "0, 8 or 16 more rays");
  rays_.resize(static_cast<std::size_t>(camera_->width()) * static_cast<std::size_t>(camera_->height()) * kPacket,
               Eigen::Vector3f::Zero());
  for_each_row([this](int y) {
    auto* ray = rays_.data() + static_cast<std::ptrdiff_t>(y) * camera_->width() * kPacket;
    for (int x = 0; x < camera_->width(); ++x) {
      for (int k = 0; k < kPacket; ++k, ++ray) {
        if (const auto found = camera_->ray(place_in_pixel(x, y, k))) *ray = found->cast<float>();
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
  const std::vector<RigidTransform> poses = spread(shutter, kPacket);
  double sum = 0.0;
  int count = 0;
  for (int y = kStride / 2; y < camera_->height(); y += kStride) {
    for (int x = kStride / 2; x < camera_->width(); x += kStride, ++count) {
      sum += shading.of(rays_of(x, y, poses), 1.0 / kSide).sum / kPacket;
    }
  }
  return count > 0 ? sum / count : 0.0;
}

Radiance Renderer::render(const Shutter& shutter, const RayScene* moving) const {
  Radiance image{camera_->width(), camera_->height(), {}};
  image.values.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  const Shading shading(world_, {world_.scene, moving}, camera_->focal_px());
  const std::vector<RigidTransform> poses = spread(shutter, kPacket);
  const std::vector<RigidTransform> edge_poses = spread(shutter, options_.edge_rays);
  const double fine_share = 1.0 / std::sqrt(kPacket + options_.edge_rays);
  const auto more_at = [&](int x, int y) {
    const Eigen::Vector3f* known = rays_.data() + (static_cast<std::ptrdiff_t>(y) * image.width + x) * kPacket;
    double sum = 0.0;
    for (int first = 0; first < options_.edge_rays; first += kPacket) {
      RayPacket rays;
      for (std::size_t k = 0; k < kPacket; ++k) {
        const int place = first + static_cast<int>(k);
        const RigidTransform& pose = edge_poses[static_cast<std::size_t>(place)];
        rays.valid[k] = true;
        rays.origin[k] = pose.translation;
        rays.direction[k] = pose.rotation * ray_between(known, place_at_edge(place, options_.edge_rays));
      }
      sum += shading.of(rays, fine_share).sum;
    }
    return sum;
  };
  for_each_row([&](int y) {
    float* row = image.values.data() + static_cast<std::ptrdiff_t>(y) * image.width;
    for (int x = 0; x < image.width; ++x) {
      const auto light = shading.of(rays_of(x, y, poses), 1.0 / kSide);
      const bool more = light.edge && light.whole;
      const int rays = kPacket + (more ? options_.edge_rays : 0);
      row[x] = static_cast<float>((light.sum + (more ? more_at(x, y) : 0.0)) / rays);
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
