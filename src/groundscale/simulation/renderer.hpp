#pragma once

#include <vector>

#include "groundscale/camera/camera.hpp"
#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/simulation/world.hpp"

namespace groundscale {

/// Light at each pixel, row by row, in units of what a white surface square to the sun sends back.
struct Radiance {
  int width = 0;
  int height = 0;
  std::vector<float> values;
};

struct RenderOptions {
  int samples = 2;       ///< Rays a side of a pixel.
  int edge_samples = 4;  ///< The same where a pixel meets more than one surface.
  int threads = 1;
};

/// Where the camera is while its shutter is open. Equal poses: no motion blur.
struct Shutter {
  RigidTransform world_from_cam_open;
  RigidTransform world_from_cam_close;
};

/// What a camera sees: a pixel's rays are spread over its area and over the time that the shutter is open. The same
/// values whatever the number of threads. Pixels without a ray stay dark.
Radiance render(const World& world, const Camera& camera, const Shutter& shutter, const RenderOptions& options);

/// The pose a share (0 to 1) of the way from one to the other, at an even rate.
RigidTransform between(const RigidTransform& from, const RigidTransform& to, double share);

}  // namespace groundscale
