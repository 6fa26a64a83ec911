#include "groundscale/experiments/source_drive.hpp"

#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "groundscale/io/text_internal.hpp"
#include "groundscale/tracking/pyramid.hpp"

namespace groundscale {
namespace {

constexpr double kKittiHeightM = 1.65;

}  // namespace

Result<SourceDrive> open_source_drive(const std::string& source, const std::string& camera, int frames) {
  use_one_thread();
  SequenceRequest request{.source = source};
  if (frames > 0) request.frames = frames;
  auto sequence = open_sequence(request, /*decode_ahead=*/false);
  if (!sequence) return sequence.error();
  const std::string path = camera.empty() ? (*sequence)->calibration_path() : camera;
  if (path.empty()) {
    return internal::bad_input(fmt::format("{}: no calibration: neither camera.yaml nor calib.txt lies there", source));
  }
  const bool kitti = std::filesystem::path(path).extension() == ".txt";
  const int width = (*sequence)->width(), height = (*sequence)->height();
  auto setup = kitti ? read_kitti_calibration(path, (*sequence)->kitti_image().value_or(0), width, height)
                     : read_camera_file(path, width, height);
  if (!setup) return setup.error();
  if (!setup->height_m && (*sequence)->kitti_image()) setup->height_m = kKittiHeightM;
  if (!setup->height_m) return internal::bad_input(fmt::format("{}: says no height_m of the camera", path));
  return SourceDrive{std::move(*sequence), std::move(*setup)};
}

}  // namespace groundscale
