#include "groundscale/simulation/camera_presets.hpp"

#include <cmath>

#include "groundscale/camera/ocam.hpp"
#include "groundscale/camera/pinhole.hpp"
#include "groundscale/simulation/named_internal.hpp"

namespace groundscale {
namespace {

CameraPtr pinhole(const PinholeParameters& parameters, int width, int height) {
  return PinholeCamera::create(parameters, width, height).value();
}

CameraPreset kitti() {
  CameraPreset preset;
  preset.camera = pinhole({.fx = 718.856,
                           .fy = 718.856,
                           .cx = 607.1928,
                           .cy = 185.2157,
                           .k1 = 0.0117,
                           .k2 = 0.0,
                           .p1 = 0.0,
                           .p2 = 0.0,
                           .k3 = 0.0},
                          1241, 376);
  preset.options.rig.pitch_deg = 0.8;
  return preset;
}

/// Outline, in the image, of a rectangle of level road beside the vehicle: metres to the left and forwards.
std::vector<double> outline_beside(const CameraPreset& preset, double near_m, double far_m, double half_length_m) {
  const Mounting mounting = preset.options.rig.mounting();
  const Eigen::Vector3d below = preset.options.rig.height_m * mounting.normal_in_cam();
  std::vector<double> outline;
  const auto add = [&](double left_m, double forward_m) {
    const auto pixel =
        preset.camera->project(below - left_m * mounting.right_in_cam() + forward_m * mounting.forward_in_cam());
    // Whole pixels are as good, and read better.
    if (pixel) outline.insert(outline.end(), {std::round(pixel->x()), std::round(pixel->y())});
  };
  constexpr int kSteps = 8;
  for (int k = -kSteps; k <= kSteps; ++k) add(near_m, half_length_m * k / kSteps);
  for (int k = kSteps; k >= -kSteps; --k) add(far_m, half_length_m * k / kSteps);
  return outline;
}

/// A lens of 170 degrees on the roof that looks to the left, over the lane that comes the other way: the right side of
/// a street has too little road.
CameraPreset campus() {
  CameraPreset preset;
  const OcamParameters lens{.polynomial = {-510.0, 0.0, 4.9e-4, -2.0e-8, 2.0e-11},
                            .cx = 961.3,
                            .cy = 538.7,
                            .c = 1.0003,
                            .d = -2e-4,
                            .e = 3e-4};
  preset.camera = OcamCamera::create(lens, 1920, 1080).value();
  preset.options.rig.height_m = 2.0;
  preset.options.rig.pitch_deg = 12.0;
  preset.options.rig.yaw_deg = -90.0;
  preset.options.rate_hz = 30.0;
  preset.region_px = outline_beside(preset, 1.0, 4.4, 5.0);
  return preset;
}

CameraPreset small() {
  CameraPreset preset;
  preset.camera = pinhole({.fx = 300.0, .fy = 300.0, .cx = 239.5, .cy = 60.0}, 480, 200);
  preset.options.edge_rays = 0;
  return preset;
}

struct NamedPreset {
  std::string_view name;
  CameraPreset (*make)();
};
constexpr NamedPreset kPresets[] = {{"kitti", kitti}, {"campus", campus}, {"small", small}};

}  // namespace

const std::vector<std::string_view>& camera_preset_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const NamedPreset& preset : kPresets) all.push_back(preset.name);
    return all;
  }();
  return names;
}

Result<CameraPreset> find_camera_preset(std::string_view name) {
  return internal::make_named(kPresets, name, "preset");
}

}  // namespace groundscale
