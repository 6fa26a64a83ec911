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

constexpr float kSkyLight = 0.3F;  ///< On level ground, of what the sun gives.
constexpr float kSunLight = 1.1F;
constexpr int kSide = 2;  ///< Rays a side of a pixel.
constexpr int kPlaces = kSide * kSide;
constexpr auto kRays = RayPacket::kRays;  ///< Of two pixels.

/// Sky: brighter towards the horizon.
float sky(const Eigen::Vector3f& direction) {
  const float up = std::max(0.0F, -direction.y());
  return 0.45F - 0.18F * std::min(1.0F, up * 1.5F);
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

  RayHits hit(const RayPacket& rays) const {
    auto hits = still.hit(rays);
    if (moving == nullptr) return hits;
    constexpr int kMovingMeshes = 1 << 24;  // told from what stands still
    auto others = moving->hit(rays);
    for (std::size_t k = 0; k < kRays; ++k) {
      if (!others[k] || (hits[k] && hits[k]->distance_m <= others[k]->distance_m)) continue;
      hits[k] = others[k];
      hits[k]->mesh += kMovingMeshes;
    }
    return hits;
  }

  RayFlags blocked(const RayPacket& rays) const {
    auto any = still.blocked(rays);
    if (moving == nullptr) return any;
    const auto others = moving->blocked(rays);
    for (std::size_t k = 0; k < kRays; ++k) any[k] = any[k] || others[k];
    return any;
  }
};

/// Light along the rays of two pixels.
class Shading {
 public:
  Shading(const World& world, const Scenes& scenes, double focal_px)
      : world_(world), scenes_(scenes), focal_px_(focal_px), sun_(world.sun().cast<float>()) {}

  struct Light {
    double sum = 0.0;   ///< Over the four rays.
    bool edge = false;  ///< They met more than one surface.
    bool whole = true;  ///< Each place has a ray.
  };

  /// Of the rays 0 to 3 and of 4 to 7.
  /// @param share  Share of a pixel's side that a ray stands for.
  std::array<Light, 2> of(const RayPacket& rays, double share) const {
    const RayHits hits = scenes_.hit(rays);
    const auto sunlight = sunlight_at(rays, hits);
    return {of_four(rays, hits, sunlight, 0, share), of_four(rays, hits, sunlight, kPlaces, share)};
  }

 private:
  using Sunlight = std::array<float, kRays>;

  Light of_four(const RayPacket& rays, const RayHits& hits, const Sunlight& sunlight, std::size_t first,
                double share) const {
    Light light;
    const auto surface = [&hits](std::size_t k) { return hits[k] ? hits[k]->mesh : -1; };
    for (std::size_t k = first; k < first + kPlaces; ++k) {
      light.edge = light.edge || surface(k) != surface(first);
      light.whole = light.whole && rays.valid[k];
    }
    const auto shared =
        light.edge || !hits[first] ? std::nullopt : albedo_of_pixel(&hits[first], rays.direction[first]);
    for (std::size_t k = first; k < first + kPlaces; ++k) {
      if (!rays.valid[k]) continue;
      if (!hits[k]) {
        light.sum += sky(rays.direction[k]);
        continue;
      }
      const double value = shared ? *shared : albedo_of_ray(*hits[k], rays.direction[k], share);
      // Half of the sky is over a wall, all of it over the ground.
      const float open = 0.5F - 0.5F * hits[k]->normal.y();
      light.sum += value * (kSkyLight * (0.3F + 0.7F * open) + sunlight[k]) + glint(*hits[k], rays.direction[k]);
    }
    return light;
  }

  Sunlight sunlight_at(const RayPacket& rays, const RayHits& hits) const {
    RayPacket to_sun;
    Sunlight light{};
    constexpr float kOffM = 2e-3F;  // off the surface, against its own roughness in single precision
    for (std::size_t k = 0; k < kRays; ++k) {
      to_sun.origin[k] = rays.origin[k];
      to_sun.direction[k] = sun_;
      const float facing = hits[k] ? hits[k]->normal.dot(sun_) : 0.0F;
      if (facing <= 0.0F) continue;
      light[k] = kSunLight * facing;
      to_sun.valid[k] = true;
      to_sun.origin[k] += hits[k]->distance_m * rays.direction[k] + kOffM * hits[k]->normal;
    }
    const RayFlags shadow = scenes_.blocked(to_sun);
    for (std::size_t k = 0; k < kRays; ++k) light[k] = shadow[k] ? 0.0F : light[k];
    return light;
  }

  double albedo_at(int material, const Eigen::Vector2d& uv, double footprint) const {
    return albedo(material, uv, footprint, {world_.options.asphalt, world_.options.profile}, world_.options.seed);
  }

  /// Over a square of the area that a ray stands for.
  double albedo_of_ray(const RayHit& hit, const Eigen::Vector3f& direction, double share) const {
    const double slant = std::max(0.02F, -hit.normal.dot(direction));
    return albedo_at(hit.material, hit.uv.cast<double>(), share * hit.distance_m / focal_px_ / std::sqrt(slant));
  }

  /// Over a pixel on one surface. At a slant it is long and narrow: a square of the same area would leave waves along
  /// it that are sampled too thinly, and what is seen would not lie where it is. So there are places along it.
  /// @return Nothing where the surface's coordinates jump between the rays.
  std::optional<double> albedo_of_pixel(const std::optional<RayHit>* hits, const Eigen::Vector3f& direction) const {
    // The rays lie half of a pixel apart.
    const Eigen::Vector2f across = hits[1]->uv - hits[0]->uv + hits[3]->uv - hits[2]->uv;
    const Eigen::Vector2f down = hits[2]->uv - hits[0]->uv + hits[3]->uv - hits[1]->uv;
    const Eigen::Vector2d along = (across.squaredNorm() > down.squaredNorm() ? across : down).cast<double>();
    const double slant = std::max(0.02F, -hits[0]->normal.dot(direction));
    const double width = hits[0]->distance_m / focal_px_;
    const double length = along.norm();
    constexpr double kJump = 2.5;
    if (length > kJump * width / slant) return std::nullopt;
    constexpr double kMostPlaces = 8.0;
    const auto count = static_cast<int>(std::clamp(std::round(length / width), 1.0, kMostPlaces));
    const double footprint = std::max(width, length / count);
    const Eigen::Vector2d middle = (0.25F * (hits[0]->uv + hits[1]->uv + hits[2]->uv + hits[3]->uv)).cast<double>();
    double sum = 0.0;
    for (int k = 0; k < count; ++k) {
      sum += albedo_at(hits[0]->material, middle + ((k + 0.5) / count - 0.5) * along, footprint);
    }
    return sum / count;
  }

  /// What of the sky a smooth surface mirrors (Schlick 1994); below the horizon it mirrors a street in shade.
  static float glint(const RayHit& hit, const Eigen::Vector3f& direction) {
    const auto square_on = static_cast<float>(mirrored(hit.material));
    if (square_on == 0.0F) return 0.0F;
    constexpr float kStreet = 0.08F;
    const float facing = std::clamp(-hit.normal.dot(direction), 0.0F, 1.0F);
    const float rest = 1.0F - facing;
    const float share = square_on + (1.0F - square_on) * rest * rest * rest * rest * rest;
    const Eigen::Vector3f onward = direction + 2.0F * facing * hit.normal;
    return share * (onward.y() < 0.0F ? sky(onward) : kStreet);
  }

  const World& world_;
  Scenes scenes_;
  double focal_px_;
  Eigen::Vector3f sun_;
};

/// Ray at a place of a pixel, from those of its 2 x 2 places: straight between them is good to a millionth of a pixel.
Eigen::Vector3f ray_between(const Eigen::Vector3f* rays, const Eigen::Vector2d& place) {
  const auto x = static_cast<float>(2.0 * place.x() + 0.5);
  const auto y = static_cast<float>(2.0 * place.y() + 0.5);
  const Eigen::Vector3f ray =
      (1.0F - y) * ((1.0F - x) * rays[0] + x * rays[1]) + y * ((1.0F - x) * rays[2] + x * rays[3]);
  return ray.normalized();
}

}  // namespace

Renderer::Renderer(const World& world, CameraPtr camera, const RenderOptions& options)
    : world_(world), camera_(std::move(camera)), options_(options) {
  GS_CHECK(options.edge_rays == 0 || options.edge_rays == 8 || options.edge_rays == 16, "0, 8 or 16 more rays");
  rays_.resize(static_cast<std::size_t>(camera_->width()) * static_cast<std::size_t>(camera_->height()) * kPlaces,
               Eigen::Vector3f::Zero());
  for_each_row([this](int y) {
    auto* ray = rays_.data() + static_cast<std::ptrdiff_t>(y) * camera_->width() * kPlaces;
    for (int x = 0; x < camera_->width(); ++x) {
      for (int k = 0; k < kPlaces; ++k, ++ray) {
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

/// A pose for each of some rays, spread over the time that the shutter is open.
std::vector<Renderer::RayPose> Renderer::spread(const Shutter& shutter, int count) {
  std::vector<RayPose> poses;
  for (int k = 0; k < count; ++k) {
    const RigidTransform pose = between(shutter.world_from_cam_open, shutter.world_from_cam_close, (k + 0.5) / count);
    poses.push_back({pose.rotation.cast<float>(), pose.translation.cast<float>()});
  }
  return poses;
}

RayPacket Renderer::rays_of(int x1, int x2, int y, const std::vector<RayPose>& poses) const {
  RayPacket rays;
  for (std::size_t k = 0; k < kRays; ++k) {
    const std::size_t place = k % kPlaces;
    const int x = k < kPlaces ? x1 : x2;
    if (x < camera_->width()) {
      const Eigen::Vector3f& ray = known_rays(x, y)[place];
      rays.direction[k] = poses[place].rotation * ray;
      rays.valid[k] = !ray.isZero();
    } else {
      rays.direction[k] = Eigen::Vector3f::UnitZ();
    }
    rays.origin[k] = poses[place].translation;
  }
  return rays;
}

double Renderer::mean_light(const Shutter& shutter, const RayScene* moving) const {
  constexpr int kStride = 8;
  const Shading shading(world_, {world_.scene, moving}, camera_->focal_px());
  const std::vector<RayPose> poses = spread(shutter, kPlaces);
  double sum = 0.0;
  int count = 0;
  for (int y = kStride / 2; y < camera_->height(); y += kStride) {
    for (int x = kStride / 2; x < camera_->width(); x += 2 * kStride) {
      const auto light = shading.of(rays_of(x, x + kStride, y, poses), 1.0 / kSide);
      sum += (light[0].sum + light[1].sum) / kPlaces;
      count += x + kStride < camera_->width() ? 2 : 1;
    }
  }
  return count > 0 ? sum / count : 0.0;
}

Radiance Renderer::render(const Shutter& shutter, const RayScene* moving) const {
  Radiance image{camera_->width(), camera_->height(), {}};
  image.values.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  const Shading shading(world_, {world_.scene, moving}, camera_->focal_px());
  const std::vector<RayPose> poses = spread(shutter, kPlaces);
  const std::vector<RayPose> edge_poses = spread(shutter, options_.edge_rays);
  const double fine_share = 1.0 / std::sqrt(kPlaces + options_.edge_rays);
  const auto more_at = [&](int x, int y) {
    double sum = 0.0;
    for (int first = 0; first < options_.edge_rays; first += static_cast<int>(kRays)) {
      RayPacket rays;
      for (std::size_t k = 0; k < kRays; ++k) {
        const int place = first + static_cast<int>(k);
        const RayPose& pose = edge_poses[static_cast<std::size_t>(place)];
        rays.valid[k] = true;
        rays.origin[k] = pose.translation;
        rays.direction[k] = pose.rotation * ray_between(known_rays(x, y), place_at_edge(place, options_.edge_rays));
      }
      const auto light = shading.of(rays, fine_share);
      sum += light[0].sum + light[1].sum;
    }
    return sum;
  };
  for_each_row([&](int y) {
    float* row = image.values.data() + static_cast<std::ptrdiff_t>(y) * image.width;
    for (int first = 0; first < image.width; first += 2) {
      const auto lights = shading.of(rays_of(first, first + 1, y, poses), 1.0 / kSide);
      for (int x = first; x < std::min(first + 2, image.width); ++x) {
        const auto& light = lights[static_cast<std::size_t>(x - first)];
        const bool more = light.edge && light.whole;
        const int rays = kPlaces + (more ? options_.edge_rays : 0);
        row[x] = static_cast<float>((light.sum + (more ? more_at(x, y) : 0.0)) / rays);
      }
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
      row[x] = std::max(0.0F, hit->distance_m * static_cast<float>(ray.z()));
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
