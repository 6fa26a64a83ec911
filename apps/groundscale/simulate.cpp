#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "groundscale/simulation/drive_simulation.hpp"
#include "progress.hpp"

namespace groundscale {
namespace {

struct SimulateArguments {
  DriveOutput output;
  std::string route = "city";
  std::string preset = "kitti";
  int frames = std::numeric_limits<int>::max();
  std::uint64_t seed = 0;
  int threads = 0;
  bool quiet = false;
};

Result<void> simulate(const SimulateArguments& arguments) {
  const auto route = find_route(arguments.route);
  if (!route) return route.error();
  auto camera = find_camera_preset(arguments.preset);
  if (!camera) return camera.error();
  const auto processors = static_cast<int>(std::thread::hardware_concurrency());
  camera->quality.threads = arguments.threads > 0 ? arguments.threads : std::max(1, processors);
  WorldOptions options;
  options.seed = arguments.seed;
  const World world = make_world(route->path, options);
  const auto frames = truth_of_drive(world, *route, *camera, arguments.frames, arguments.seed);
  {
    Progress progress(!arguments.quiet, static_cast<int>(frames.size()));
    const auto written = write_drive(world, frames, *camera, arguments.output, arguments.seed,
                                     [&progress](int done) { progress.show(done, ""); });
    if (!written) return written;
  }
  fmt::print("{} frames of '{}' as '{}' sees it, seed {}: {}\n", frames.size(), arguments.route, arguments.preset,
             arguments.seed, arguments.output.folder);
  return {};
}

}  // namespace

void add_simulate(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("simulate", "A drive with exact truth, in KITTI odometry's layout");
  const auto arguments = std::make_shared<SimulateArguments>();
  command->add_option("--output", arguments->output.folder, "Folder for the drive")->required();
  command->add_option("--route", arguments->route, "Built-in route");
  command->add_option("--preset", arguments->preset, "Camera and its place on the vehicle");
  command->add_option("--frames", arguments->frames, "At most so many frames")->check(CLI::Range(2, 1000000));
  command->add_option("--seed", arguments->seed, "Of world, vehicle and sensor")->check(CLI::NonNegativeNumber);
  command->add_option("--threads", arguments->threads, "The images are the same with any number")
      ->check(CLI::PositiveNumber);
  command->add_flag("--force", arguments->output.force, "Write into a folder that holds something");
  command->add_flag("--quiet", arguments->quiet, "No progress");
  command->callback([arguments, &exit_status] {
    const Result<void> done = simulate(*arguments);
    exit_status = done ? kDone : report_failure(done.error());
  });
}

}  // namespace groundscale
