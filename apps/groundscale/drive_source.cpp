#include "drive_source.hpp"

#include <cmath>
#include <filesystem>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "groundscale/io/config.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "groundscale/tracking/pyramid.hpp"

namespace groundscale {
namespace {

constexpr double kKittiHeightM = 1.65;

template <class Value>
void replace(const std::optional<Value>& given, Value& value) {
  if (given) value = *given;
}

}  // namespace

void add_source_options(CLI::App& command, SourceArguments& arguments) {
  command.add_option("SOURCE", arguments.source,
                     "KITTI odometry folder, image folder or video; may come from --config's file");
  command.add_option("--road-masks", arguments.road_masks, "Folder with an image a frame, 0 = not road");
  add_drive_options(command, arguments);
}

void add_drive_options(CLI::App& command, SourceArguments& arguments) {
  command.add_option("--camera", arguments.camera_file, "Camera file (docs/formats.md)");
  command.add_option("--camera-height", arguments.camera_height_m, "Metres above the road");
  command.add_option("--image", arguments.kitti_image, "KITTI's image folder")->check(CLI::Range(0, 3));
  command.add_option("--config", arguments.config_file, "Configuration file; the config.yaml of a run repeats it");
  command.add_option("--set", arguments.assignments, "KEY=VALUE of the configuration")->expected(1)->take_all();
  command.add_option("--start", arguments.start, "First frame")->check(CLI::NonNegativeNumber);
  command.add_option("--frames", arguments.frames, "At most so many frames")->check(CLI::PositiveNumber);
  command.add_option("--seed", arguments.seed, "Of all random draws")->check(CLI::NonNegativeNumber);
}

Result<RunConfig> read_config(const SourceArguments& arguments) {
  RunConfig config;
  const VisitOptions visit = [&config](FieldVisitor& visitor) { visit_fields(config, visitor); };
  if (!arguments.config_file.empty()) {
    const auto text = read_text(arguments.config_file);
    if (!text) return text.error();
    if (const auto done = apply_yaml(*text, arguments.config_file, visit); !done) return done.error();
  }
  for (const std::string& assignment : arguments.assignments) {
    if (const auto done = apply_assignment(assignment, visit); !done) return done.error();
  }
  replace(arguments.seed, config.odometry.seed);
  replace(arguments.source, config.run.source);
  replace(arguments.kitti_image, config.run.image);
  replace(arguments.start, config.run.start);
  replace(arguments.frames, config.run.frames);
  replace(arguments.camera_file, config.run.camera);
  replace(arguments.road_masks, config.run.road_masks);
  if (config.run.source.empty()) {
    return Error{ErrorCode::kBadInput, "SOURCE is missing: on the command line, or run.source in the file of --config"};
  }
  if (const auto valid = config.validate(); !valid) return valid.error();
  return config;
}

Result<std::unique_ptr<Sequence>> open_drive(const RunSource& source) {
  use_one_thread();  // before images are read ahead
  auto sequence = open_sequence(source.request(), /*decode_ahead=*/true);
  if (!sequence) return sequence;
  constexpr int kMinFrames = 2;
  if ((*sequence)->frame_count() >= kMinFrames) return sequence;
  return Error{ErrorCode::kBadInput, fmt::format("{}: {} frame, at least {} are needed", source.source,
                                                 (*sequence)->frame_count(), kMinFrames)};
}

Result<CameraChoice> choose_camera(const SourceArguments& arguments, const RunSource& source,
                                   const Sequence& sequence) {
  CameraChoice choice;
  const std::string path = source.camera.empty() ? sequence.calibration_path() : source.camera;
  if (path.empty()) {
    return Error{
        ErrorCode::kBadInput,
        fmt::format("{}: no calibration: neither camera.yaml nor calib.txt lies there; --camera FILE names one",
                    source.source)};
  }
  choice.camera_from = path;
  const bool kitti = std::filesystem::path(path).extension() == ".txt";
  auto setup =
      kitti ? read_kitti_calibration(path, sequence.kitti_image().value_or(0), sequence.width(), sequence.height())
            : read_camera_file(path, sequence.width(), sequence.height());
  if (!setup) return setup.error();
  choice.setup = std::move(*setup);
  if (const auto chosen = choose_height(arguments, source, sequence, choice); !chosen) return chosen.error();
  return choice;
}

Result<void> choose_height(const SourceArguments& arguments, const RunSource& source, const Sequence& sequence,
                           CameraChoice& choice) {
  std::optional<double>& height_m = choice.setup.height_m;
  if (arguments.camera_height_m) {
    height_m = arguments.camera_height_m;
    choice.height_from = "--camera-height";
  } else if (source.camera_height_m > 0.0) {
    height_m = source.camera_height_m;
    choice.height_from = "run.camera_height_m";
  } else if (height_m) {
    choice.height_from = choice.camera_from;
  } else if (sequence.kitti_image()) {
    height_m = kKittiHeightM;
    choice.height_from = "KITTI's documented height";
  }
  if (choice.height_from != choice.camera_from) choice.setup.height_sd_m.reset();
  if (height_m && (!std::isfinite(*height_m) || *height_m <= 0.0)) {
    return Error{ErrorCode::kBadInput, fmt::format("the camera height is {} m, it must be above 0", *height_m)};
  }
  return {};
}

Result<CameraSetup> metric_camera(const SourceArguments& arguments, const RunSource& source, const Sequence& sequence,
                                  RunSummary& summary) {
  auto choice = choose_camera(arguments, source, sequence);
  if (!choice) return choice.error();
  if (!choice->setup.height_m) {
    return Error{ErrorCode::kBadInput,
                 "the camera height is missing: --camera-height M, or height_m in the camera file"};
  }
  summary.camera_from = choice->camera_from;
  summary.camera_height_from = choice->height_from;
  summary.camera_height_m = *choice->setup.height_m;
  if (summary.camera_height_m > kUnlikelyHeightM) {
    summary.warnings.push_back(
        fmt::format("the camera height is {} m: is it given in metres?", summary.camera_height_m));
  }
  return std::move(choice->setup);
}

Result<Trajectory> open_truth(const std::string& path, const Sequence& sequence) {
  if (path.empty()) return Trajectory();
  auto truth = read_trajectory(path);
  if (!truth) return Error{ErrorCode::kBadInput, "--truth " + truth.error().message};
  const int needed = sequence.first_frame() + sequence.frame_count();
  if (truth->size() >= needed) return truth;
  return Error{ErrorCode::kBadInput, fmt::format("--truth {}: {} rows, but the last frame is {}: it must have at least "
                                                 "{} rows",
                                                 path, truth->size(), needed - 1, needed)};
}

std::optional<double> true_step_m(const Trajectory& truth, int frame) {
  if (frame < 1 || frame >= truth.size()) return std::nullopt;
  const auto& poses = truth.world_from_cam;
  const auto row = static_cast<std::size_t>(frame);
  return (poses[row].translation - poses[row - 1].translation).norm();
}

std::string config_in_force(RunConfig config, const Sequence& sequence, const RunSummary& summary) {
  config.run.camera = summary.camera_from;
  config.run.camera_height_m = summary.camera_height_m;
  config.run.image = sequence.kitti_image().value_or(config.run.image);
  config = config.absolute();
  return to_yaml([&config](FieldVisitor& visitor) { visit_fields(config, visitor); });
}

Result<std::optional<RoadMasks>> open_masks(const std::string& folder, const Sequence& sequence) {
  if (folder.empty()) return std::optional<RoadMasks>();
  auto masks = RoadMasks::open(folder, sequence);
  if (!masks) return masks.error();
  return std::optional<RoadMasks>(std::move(*masks));
}

Image mask_of(const Frame& frame, const std::optional<RoadMasks>& masks, std::vector<std::string>& warnings) {
  if (!masks || frame.image.empty()) return {};
  const auto mask = masks->read(frame.index);
  if (mask) return *mask;
  warnings.push_back(fmt::format("frame {} goes without road mask: {}", frame.index, mask.error().message));
  return {};
}

}  // namespace groundscale
