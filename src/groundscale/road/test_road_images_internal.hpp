#pragma once

#include "groundscale/camera/kannala_brandt.hpp"
#include "groundscale/camera/pinhole.hpp"
#include "groundscale/plane/observations.hpp"
#include "groundscale/tracking/test_texture_internal.hpp"

namespace groundscale {

/// A flat road of waves of grey, seen exactly by two cameras: each pixel's ray meets the plane where it meets it.
struct TestRoadImages {
  CameraPtr camera;
  RigidTransform motion;  ///< |t| = 1.
  GroundPlane road;       ///< In the first camera.
  double gain = 1.0;      ///< Of the second image.
  double offset = 0.0;
  std::uint64_t seed = 1;

  Image render(bool second) const {
    // Waves no shorter than three pixels where the region ends: these images have no lens that would blur shorter ones.
    const TestTexture texture(seed, 0.5);
    const GroundPlane plane = second ? road.seen_from(motion) : road;
    const RigidTransform back = second ? motion.inverse() : RigidTransform{};
    Image image(camera->width(), camera->height());
    std::uint8_t* pixel = image.data();
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x, ++pixel) {
        const auto ray = camera->ray({x, y});
        const double fall = ray ? plane.normal_in_cam.dot(*ray) : 0.0;
        *pixel = 60;
        if (fall < 0.02) continue;
        const Eigen::Vector3d point = back * Eigen::Vector3d(*ray * plane.height / fall);
        double grey = 127.0 + 0.4 * (texture.at(point.x(), point.z()) - 127.0);
        if (second) grey = (grey - offset) / gain;
        *pixel = static_cast<std::uint8_t>(std::lround(std::clamp(grey, 0.0, 255.0)));
      }
    }
    return image;
  }

  /// With the road from 4 to 9 steps ahead and 2 to each side as region, and the true plane as predicted.
  RoadObservations observations() const {
    RoadObservations result;
    result.camera = camera;
    result.cam_from_reference = {RigidTransform{}, motion};
    result.predicted_plane = road;
    result.images = {render(false), render(true)};
    result.region = Image(camera->width(), camera->height());
    for (int y = 0; y < camera->height(); ++y) {
      for (int x = 0; x < camera->width(); ++x) {
        const auto ray = camera->ray({x, y});
        const double fall = ray ? road.normal_in_cam.dot(*ray) : 0.0;
        const Eigen::Vector3d point =
            fall > 0.02 ? Eigen::Vector3d(*ray * road.height / fall) : Eigen::Vector3d::Zero();
        const bool inside = point.z() > 4.0 && point.z() < 9.0 && std::abs(point.x()) < 2.0;
        result.region.data()[y * camera->width() + x] = inside ? 255 : 0;
      }
    }
    return result;
  }
};

}  // namespace groundscale
