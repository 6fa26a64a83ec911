#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "drive_source.hpp"
#include "groundscale/calibration/calibrate.hpp"
#include "groundscale/io/camera_file.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;

struct CalibrateArguments {
  std::vector<std::string> sources;
  SourceArguments source;  ///< Of each of them.
  std::string output;
  bool force = false;
};

Error bad_input(std::string message) { return {ErrorCode::kBadInput, std::move(message)}; }

Result<void> check_output(const CalibrateArguments& a, const std::string& camera_from) {
  std::error_code ignored;
  if (fs::is_directory(a.output, ignored)) {
    return bad_input(fmt::format("--output {}: is a folder, a file is needed", a.output));
  }
  if (!fs::exists(a.output, ignored)) {
    const fs::path folder = fs::path(a.output).parent_path();
    if (folder.empty() || fs::is_directory(folder, ignored)) return {};
    return bad_input(fmt::format("--output {}: there is no folder {}", a.output, folder.string()));
  }
  if (!camera_from.empty() && fs::equivalent(a.output, camera_from, ignored)) {
    return bad_input(fmt::format("--output {}: is read, another is needed", a.output));
  }
  if (!a.force) return bad_input(fmt::format("--output {}: exists; --force overwrites it", a.output));
  return {};
}

std::string slope_text(const ScaleSlope& slope) {
  return fmt::format("{:+.1f} +- {:.1f} % per 100 m", 100.0 * slope.per_100m, 100.0 * slope.sd_per_100m);
}

/// What came out, a line each; for the terminal, and as comment in the file.
std::string found_text(const Calibration& calibration, const Camera& camera) {
  std::string text;
  const auto line = [&text](const std::string& name, const std::string& value) {
    text += fmt::format("{:<20} {}\n", name, value);
  };
  line("seen", fmt::format("{} frames, {:.0f} m, {:.0f} degrees of turning", calibration.frames, calibration.length_m,
                           calibration.turned_deg));
  for (const CalibratedParameter& parameter : calibration.parameters) {
    const std::string name(file_name_of(parameter.parameter, camera));
    line(name, parameter.reason.empty()
                   ? fmt::format("{:.6g} -> {:.6g} +- {:.2g}", parameter.before, parameter.after, parameter.sd)
                   : fmt::format("{:.6g}, stays: {}", parameter.before, parameter.reason));
  }
  if (calibration.radial_by_tracks.sd > 0.0) {
    const std::string slope = calibration.radial_by_slope ? fmt::format("{:.6g} +- {:.2g}", calibration.radial_by_slope->value,
                                                                        calibration.radial_by_slope->sd)
                                                          : "nothing";
    line("two ways", fmt::format("tracks say {:.6g} +- {:.2g}, the drift of the scale {}",
                                 calibration.radial_by_tracks.value, calibration.radial_by_tracks.sd, slope));
  }
  if (calibration.slope_before) line("drift of the scale", slope_text(*calibration.slope_before));
  if (calibration.slope_after) line("with the new camera", slope_text(*calibration.slope_after));
  if (calibration.held_out_before_px > 0.0) {
    line("tracks held out", fmt::format("{:.3f} px before, {:.3f} px after", calibration.held_out_before_px,
                                        calibration.held_out_after_px));
  }
  return text;
}

/// The drives, and the camera that all of them have.
struct Plan {
  RunConfig config;
  CameraChoice camera;
  std::vector<CalibrationDrive> drives;
};

Result<Plan> make_plan(const CalibrateArguments& a) {
  Plan plan;
  for (std::size_t k = 0; k < a.sources.size(); ++k) {
    SourceArguments own = a.source;
    own.source = a.sources[k];
    auto config = read_config(own);
    if (!config) return config.error();
    auto sequence = open_drive(config->run);
    if (!sequence) return sequence.error();
    if (k == 0) {
      auto camera = choose_camera(own, config->run, **sequence);
      if (!camera) return camera.error();
      plan.camera = std::move(*camera);
      plan.config = *config;
    }
    const Camera& camera = *plan.camera.setup.camera;
    if ((*sequence)->width() != camera.width() || (*sequence)->height() != camera.height()) {
      return bad_input(fmt::format("{}: images of {} x {} px, the camera has {} x {}", a.sources[k],
                                   (*sequence)->width(), (*sequence)->height(), camera.width(), camera.height()));
    }
    plan.drives.push_back({a.sources[k], [source = config->run] { return open_drive(source); }});
  }
  return plan;
}

Result<void> calibrate_and_write(const CalibrateArguments& a) {
  auto plan = make_plan(a);
  if (!plan) return plan.error();
  if (!plan->camera.setup.height_m) {
    // Lengths don't matter here, but the road must be found.
    constexpr double kAssumedHeightM = 1.5;
    say(fmt::format("nothing says the camera's height: {} m are assumed, and not written", kAssumedHeightM));
  }
  if (const auto free = check_output(a, plan->camera.camera_from); !free) return free;
  CameraSetup setup = plan->camera.setup;
  setup.height_m = setup.height_m.value_or(1.5);
  const auto calibration = calibrate(plan->drives, setup, plan->config.odometry, {});
  if (!calibration) return calibration.error();
  const std::string found = found_text(*calibration, *calibration->camera);
  CameraSetup result = plan->camera.setup;
  result.camera = calibration->camera;
  std::string comment = "by groundscale " GROUNDSCALE_VERSION ", from " + plan->camera.camera_from + "\n";
  for (const CalibrationDrive& drive : plan->drives) comment += "drive                " + drive.name + "\n";
  if (const auto written = write_camera_file(a.output, result, comment + found); !written) return written;
  fmt::print("{}{:<20} {}\n{:<20} {}\n", found, "verdict", calibration->verdict, "written to", a.output);
  return {};
}

}  // namespace

void add_calibrate(CLI::App& app, int& exit_status) {
  auto arguments = std::make_shared<CalibrateArguments>();
  CLI::App* command = app.add_subcommand("calibrate", "The camera's distortion and principal row from drives");
  add_source_options(*command, arguments->source);
  command->add_option("--output", arguments->output, "Camera file for the result")->required();
  command->add_flag("--force", arguments->force, "Overwrite the output");
  command->callback([arguments, &exit_status] {
    const auto done = calibrate_and_write(*arguments);
    exit_status = done ? kDone : report_failure(done.error());
  });
}

}  // namespace groundscale
