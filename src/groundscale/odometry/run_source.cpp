#include "groundscale/odometry/run_source.hpp"

#include <filesystem>
#include <limits>
#include <system_error>

namespace groundscale {
namespace {

std::string absolute_path(const std::string& path) {
  if (path.empty()) return path;
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(path, error);
  return error ? path : absolute.lexically_normal().string();
}

}  // namespace

SequenceRequest RunSource::request() const {
  SequenceRequest request{.source = source, .start = start};
  if (image >= 0) request.kitti_image = image;
  if (frames > 0) request.frames = frames;
  return request;
}

void visit_fields(RunSource& source, FieldVisitor& visitor) {
  constexpr double kMaxInt = std::numeric_limits<int>::max();
  visitor.field({.key = "source", .unit = "", .help = "KITTI odometry folder, image folder or video: SOURCE"},
                source.source);
  visitor.field({.key = "image",
                 .unit = "",
                 .help = "KITTI's image folder: --image; -1 is image_0, else the first that is there",
                 .min = -1,
                 .max = 3},
                source.image);
  visitor.field({.key = "start", .unit = "", .help = "first frame: --start", .min = 0, .max = kMaxInt}, source.start);
  visitor.field({.key = "frames", .unit = "", .help = "at most so many: --frames; 0 is all", .min = 0, .max = kMaxInt},
                source.frames);
  visitor.field(
      {.key = "camera", .unit = "", .help = "camera file: --camera; \"\" is the one that lies with the images"},
      source.camera);
  visitor.field({.key = "camera_height_m",
                 .unit = "m",
                 .help = "above the road: --camera-height; 0 is the camera file's, else KITTI's",
                 .min = 0},
                source.camera_height_m);
  visitor.field({.key = "road_masks", .unit = "", .help = "folder of road masks: --road-masks; \"\" is none"},
                source.road_masks);
}

void visit_fields(RunConfig& config, FieldVisitor& visitor) {
  visit_fields(config.odometry, visitor);
  visitor.group("run", config.run);
}

Result<void> RunConfig::validate() const {
  if (const auto ranges = check_ranges(run); !ranges) return ranges;
  return odometry.validate();
}

RunConfig RunConfig::absolute() const {
  RunConfig whole = *this;
  for (std::string* path : {&whole.run.source, &whole.run.camera, &whole.run.road_masks,
                            &whole.odometry.road.network.file, &whole.odometry.scale.speed.file}) {
    *path = absolute_path(*path);
  }
  return whole;
}

}  // namespace groundscale
