#include "groundscale/experiments/distorted_camera.hpp"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/simulation/camera_presets.hpp"

namespace groundscale {
namespace {

/// The preset's camera with this distortion alone.
Result<CameraSetup> with_distortion(const CameraPreset& preset, const std::string& name, double k1) {
  const auto* pinhole = dynamic_cast<const PinholeCamera*>(preset.camera.get());
  if (pinhole == nullptr) {
    return Error{ErrorCode::kBadInput, fmt::format("--distortion: the camera of preset '{}' is no pinhole", name)};
  }
  const PinholeParameters& p = pinhole->parameters();
  const PinholeParameters other{.fx = p.fx, .fy = p.fy, .cx = p.cx, .cy = p.cy, .k1 = k1};
  const auto camera = PinholeCamera::create(other, preset.camera->width(), preset.camera->height());
  if (!camera) return Error{camera.error().code, fmt::format("--distortion {}: {}", k1, camera.error().message)};
  CameraSetup setup;
  setup.camera = *camera;
  return setup;
}

}  // namespace

Result<void> check_distortion(const std::string& preset, double k1) {
  const auto found = find_camera_preset(preset);
  if (!found) return found.error();
  const auto setup = with_distortion(*found, preset, k1);
  return setup ? Result<void>() : setup.error();
}

Result<DistortedCameras> write_distorted_cameras(const std::string& preset, double k1, const std::string& folder) {
  const auto found = find_camera_preset(preset);
  if (!found) return found.error();
  const auto distorted = with_distortion(*found, preset, k1);
  if (!distorted) return distorted.error();
  auto plain = with_distortion(*found, preset, 0.0);
  if (!plain) return plain.error();
  plain->height_m = found->options.rig.height_m;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const DistortedCameras cameras{.rendered = (std::filesystem::path(folder) / "rendered.yaml").string(),
                                 .believed = (std::filesystem::path(folder) / "believed.yaml").string()};
  if (const auto written = write_camera_file(cameras.rendered, *distorted); !written) return written.error();
  if (const auto written = write_camera_file(cameras.believed, *plain); !written) return written.error();
  return cameras;
}

}  // namespace groundscale
