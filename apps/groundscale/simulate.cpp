#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/config.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/times_file.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "groundscale/simulation/drive_writer.hpp"
#include "progress.hpp"

namespace groundscale {
namespace {

struct SimulateArguments {
  DriveOutput output;
  std::string route = "city";
  std::string trajectory;
  std::string times;
  std::string preset = "kitti";
  std::string camera;
  std::vector<std::string> assignments;
  std::uint64_t seed = 0;
  int threads = 0;
  bool no_cache = false;
  bool quiet = false;
};

constexpr int kLargestPx = 16384;
constexpr double kMostPx = 64e6;  // 48 bytes of rays each

/// The preset with the camera file's camera and mounting, then what --set says. A route's surroundings lie between.
Result<CameraPreset> camera_of(const SimulateArguments& arguments, Surroundings surroundings) {
  Result<CameraPreset> preset = find_camera_preset(arguments.preset);
  if (!preset) return preset;
  if (!arguments.camera.empty()) {
    const Result<CameraSetup> setup = read_camera_file(arguments.camera, 0, 0);
    if (!setup) return setup.error();
    constexpr double kDegPerRad = 180.0 / std::numbers::pi;
    CameraRig& rig = preset->options.rig;
    preset->camera = setup->camera;
    preset->region_px.clear();
    if (setup->height_m) rig.height_m = *setup->height_m;
    if (setup->pitch_rad) rig.pitch_deg = kDegPerRad * *setup->pitch_rad;
    if (setup->roll_rad) rig.roll_deg = kDegPerRad * *setup->roll_rad;
    if (setup->yaw_rad) rig.yaw_deg = kDegPerRad * *setup->yaw_rad;
  }
  const int width = preset->camera->width();
  const int height = preset->camera->height();
  if (std::max(width, height) > kLargestPx || static_cast<double>(width) * height > kMostPx) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("{}: images of {} x {} px; up to {} px a side and {:.0f} in all are rendered",
                             arguments.camera, width, height, kLargestPx, kMostPx)};
  }
  SimulationOptions& options = preset->options;
  set_surroundings(surroundings, options.world);
  const auto visit = [&options](FieldVisitor& visitor) { visit_fields(options, visitor); };
  for (const std::string& assignment : arguments.assignments) {
    if (auto done = apply_assignment(assignment, visit); !done) return done.error();
  }
  if (auto checked = validate(options); !checked) return checked.error();
  return preset;
}

/// Times of the poses: of the file, else those that came with them, else even ones. They must rise.
Result<std::vector<double>> times_of(const Trajectory& poses, const SimulateArguments& arguments, double rate_hz) {
  std::vector<double> times_s = poses.times_s;
  if (!arguments.times.empty()) {
    auto read = read_times(arguments.times, poses.size(), "pose");
    if (!read) return read;
    times_s = std::move(*read);
  }
  for (std::size_t k = 1; k < times_s.size(); ++k) {
    if (times_s[k] > times_s[k - 1]) continue;
    return Error{ErrorCode::kBadInput,
                 fmt::format("{}: rows {} and {} both have the time {} s, each pose must have a later one than the "
                             "pose before",
                             arguments.times.empty() ? arguments.trajectory : arguments.times, k, k + 1, times_s[k])};
  }
  if (!times_s.empty()) return times_s;
  for (int k = 0; k < poses.size(); ++k) times_s.push_back(k / rate_hz);
  return times_s;
}

/// What can be known before the world is made, which takes seconds.
Result<void> check_output(const DriveOutput& output, int frames, const std::string& of_what) {
  if (output.frames > frames) {
    return Error{ErrorCode::kBadInput, fmt::format("--frames {}: {} has {} frames", output.frames, of_what, frames)};
  }
  return check_output_folder("--output", output.folder, output.force);
}

Result<SimulatedDrive> plan_route(const SimulateArguments& arguments) {
  const auto route = find_route(arguments.route);
  if (!route) return route.error();
  const auto camera = camera_of(arguments, route->surroundings);
  if (!camera) return camera.error();
  const auto frames = static_cast<int>(drive(*route, camera->options.rate_hz, {}).size());
  if (auto fits = check_output(arguments.output, frames, "route " + arguments.route); !fits) return fits.error();
  return drive_along(*route, *camera, arguments.seed);
}

Result<SimulatedDrive> plan_trajectory(const SimulateArguments& arguments) {
  const auto camera = camera_of(arguments, Surroundings::kTown);
  if (!camera) return camera.error();
  const Result<Trajectory> poses = read_trajectory(arguments.trajectory);
  if (!poses) return poses.error();
  const auto times_s = times_of(*poses, arguments, camera->options.rate_hz);
  if (!times_s) return times_s.error();
  if (auto fits = check_output(arguments.output, poses->size(), arguments.trajectory); !fits) return fits.error();
  auto drive = drive_along(*poses, *times_s, *camera, arguments.seed);
  if (!drive) return Error{drive.error().code, fmt::format("{}: {}", arguments.trajectory, drive.error().message)};
  return drive;
}

/// How the drive can be had again, together with simulation.yaml's options.
std::string source_of(const SimulateArguments& arguments) {
  std::string text = arguments.trajectory.empty() ? "route " + arguments.route : "trajectory " + arguments.trajectory;
  if (!arguments.times.empty()) text += ", times " + arguments.times;
  text += ", preset " + arguments.preset;
  if (!arguments.camera.empty()) text += ", camera " + arguments.camera;
  return fmt::format("{}, seed {}", text, arguments.seed);
}

/// What is read must not be what is written over.
Result<void> check_inputs(const SimulateArguments& arguments) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path output = fs::weakly_canonical(arguments.output.folder, error);
  const std::pair<const char*, std::string> inputs[] = {
      {"--trajectory", arguments.trajectory}, {"--times", arguments.times}, {"--camera", arguments.camera}};
  for (const auto& [option, file] : inputs) {
    if (file.empty() || fs::weakly_canonical(file, error).parent_path() != output) continue;
    return Error{ErrorCode::kBadInput,
                 fmt::format("{} {}: lies in --output {}, where the drive's own files would replace it", option, file,
                             arguments.output.folder)};
  }
  return {};
}

Result<void> simulate(const SimulateArguments& arguments) {
  if (auto checked = check_inputs(arguments); !checked) return checked;
  const auto drive = arguments.trajectory.empty() ? plan_route(arguments) : plan_trajectory(arguments);
  if (!drive) return drive.error();
  DriveOutput output = arguments.output;
  const auto processors = static_cast<int>(std::thread::hardware_concurrency());
  output.threads = arguments.threads > 0 ? arguments.threads : std::max(1, processors);
  if (!arguments.no_cache) output.cache_folder = user_cache_folder();
  const int frames = output.frames > 0 ? output.frames : static_cast<int>(drive->moments.size());
  {
    Progress progress(!arguments.quiet, frames);
    const auto written =
        write_drive(*drive, output, source_of(arguments), [&progress](int done) { progress.show(done, ""); });
    if (!written) return written;
  }
  fmt::print("{} frames, {}: {}\n", frames, source_of(arguments), output.folder);
  return {};
}

}  // namespace

void add_simulate(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("simulate", "A drive with exact truth, in KITTI odometry's layout");
  const auto arguments = std::make_shared<SimulateArguments>();
  DriveOutput& output = arguments->output;
  command->add_option("--output", output.folder, "Folder for the drive")->required();
  CLI::Option* route = command->add_option("--route", arguments->route, "Built-in route (city where none is named)");
  CLI::Option* trajectory =
      command->add_option("--trajectory", arguments->trajectory, "Poses (KITTI or TUM rows) to lay a road under");
  route->excludes(trajectory);
  command->add_option("--times", arguments->times, "A row a pose, in seconds")->needs(trajectory);
  command->add_option("--preset", arguments->preset, "Camera and its place on the vehicle");
  command->add_option("--camera", arguments->camera, "Camera file instead of the preset's camera and mounting");
  command->add_option("--set", arguments->assignments, "KEY=VALUE of the options, as simulation.yaml has them")
      ->expected(1)
      ->take_all();
  command->add_option("--frames", output.frames, "The first so many frames")->check(CLI::Range(1, 10000000));
  command->add_option("--seed", arguments->seed, "Of world, vehicle and sensor")
      ->check(CLI::Range(0, std::numeric_limits<int>::max()));
  command->add_option("--threads", arguments->threads, "The images are the same with any number")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--depth", output.depth, "Depth images too");
  command->add_flag("--road-masks", output.road_masks, "Images of where the road is too, for run --road-masks");
  command->add_flag("--no-cache", arguments->no_cache, "Neither read nor keep images under the user's cache folder");
  command->add_flag("--force", output.force, "Write into a folder that holds something");
  command->add_flag("--quiet", arguments->quiet, "No progress");
  command->callback([arguments, &exit_status] {
    const Result<void> done = simulate(*arguments);
    exit_status = done ? kDone : report_failure(done.error());
  });
}

}  // namespace groundscale
