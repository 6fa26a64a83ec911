#pragma once

#include <vector>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/image.hpp"
#include "groundscale/simulation/camera_motion.hpp"
#include "groundscale/simulation/world.hpp"

namespace groundscale {

/// Light at each pixel, row by row, in units of what a white surface square to the sun sends back.
struct Radiance {
  int width = 0;
  int height = 0;
  std::vector<float> values;
};

struct RenderOptions {
  int edge_rays = 8;  ///< More rays for a pixel whose first four meet more than one surface: 0, 8 or 16.
  int threads = 1;
};

/// What a camera sees of a world. A pixel's rays are spread over its area and over the time that the shutter is open.
/// The same values whatever the number of threads. Pixels without a ray stay dark.
class Renderer {
 public:
  /// The world must outlive the renderer.
  Renderer(const World& world, CameraPtr camera, const RenderOptions& options);

  /// @param moving  What moves, as it lies in the middle of the exposure; none where null.
  Radiance render(const Shutter& shutter, const RayScene* moving = nullptr) const;

  /// Mean of the light of every eighth pixel in both directions.
  double mean_light(const Shutter& shutter, const RayScene* moving = nullptr) const;

  /// Distance along the optical axis to what the middle of each pixel meets, in metres; 0 where it meets nothing.
  std::vector<float> depth(const RigidTransform& world_from_cam, const RayScene* moving = nullptr) const;
  /// 255 where the middle of a pixel meets the road within its kerbs, 0 elsewhere.
  Image road_mask(const RigidTransform& world_from_cam, const RayScene* moving = nullptr) const;

 private:
  /// A camera's pose in the precision of rays.
  struct RayPose {
    Eigen::Matrix3f rotation;
    Eigen::Vector3f translation;
  };
  static std::vector<RayPose> spread(const Shutter& shutter, int count);

  template <class Row>
  void for_each_row(const Row& row) const;
  std::optional<RayHit> middle_hit(int x, int y, const RigidTransform& world_from_cam, const RayScene* moving) const;

  /// Of two pixels of a row; the second may lie outside the image.
  RayPacket rays_of(int x1, int x2, int y, const std::vector<RayPose>& poses) const;
  const Eigen::Vector3f* known_rays(int x, int y) const {
    return rays_.data() + (static_cast<std::ptrdiff_t>(y) * camera_->width() + x) * 4;
  }

  const World& world_;
  CameraPtr camera_;
  RenderOptions options_;
  std::vector<Eigen::Vector3f> rays_;
};

}  // namespace groundscale
