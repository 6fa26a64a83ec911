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

/// What a camera sees. The same values whatever the number of threads. Pixels without a ray stay dark.
Radiance render(const World& world, const Camera& camera, const RigidTransform& world_from_cam,
                const RenderOptions& options);

}  // namespace groundscale
