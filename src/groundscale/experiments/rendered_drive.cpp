#include "groundscale/experiments/rendered_drive.hpp"

#include <fmt/format.h>

#include "groundscale/experiments/recorded_drive.hpp"
#include "groundscale/experiments/work_unit.hpp"
#include "groundscale/simulation/world.hpp"

namespace groundscale {
namespace {

/// Pose, time and camera files by what is in them, not by where they lie.
Result<std::string> key_of(DriveChoice drive, DriveOptions options) {
  for (std::string* file : {&drive.poses, &drive.times, &options.camera}) {
    if (file->empty()) continue;
    const auto digest = file_digest(*file);
    if (!digest) return digest.error();
    *file = *digest;
  }
  return fmt::format("{}, world {}\n{}\n", program_version(), kWorldVersion,
                     shell_line(simulate_arguments(drive, options)));
}

}  // namespace

Result<RenderedDrive> obtain_drive(const DriveChoice& drive, const DriveOptions& options, const std::string& folder,
                                   const ExperimentRequest& request) {
  if (!drive.recorded.empty()) return recorded_drive(drive);
  const auto key = key_of(drive, options);
  if (!key) return key.error();
  std::vector<std::string> arguments = simulate_arguments(drive, options);
  arguments.insert(arguments.begin() + 1, {"--output", folder});
  const RenderedDrive rendered_drive{
      .name = drive.name, .folder = folder, .key = *key, .command = step_command(arguments)};

  if (options.threads > 0) arguments.insert(arguments.end(), {"--threads", fmt::to_string(options.threads)});
  if (request.quiet) arguments.emplace_back("--quiet");
  const auto rendered = WorkUnit(folder, *key).complete(request.force, [&]() -> Result<void> {
    request.say(fmt::format("{}: rendering {} frames", drive.name, drive.frames));
    const auto step = run_step(request, arguments);
    return step ? Result<void>() : step.error();
  });
  if (!rendered) return rendered.error();
  return rendered_drive;
}

}  // namespace groundscale
