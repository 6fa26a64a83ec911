#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "drive_source.hpp"
#include "groundscale/calibration/calibrate.hpp"
#include "groundscale/calibration/focal_search.hpp"
#include "groundscale/camera/pinhole.hpp"
#include "groundscale/io/camera_file.hpp"
#include "output_files.hpp"
#include "progress.hpp"

namespace groundscale {
namespace {

struct CalibrateArguments {
  std::vector<std::string> sources;
  SourceArguments source;  ///< Of each of them.
  std::optional<double> fov_deg;
  std::string output;
  bool force = false;
  bool quiet = false;
};

/// Where nothing is known of the height: a camera behind the windscreen of a car.
constexpr double kAssumedHeightM = 1.5;

Error bad_input(std::string message) { return {ErrorCode::kBadInput, std::move(message)}; }

/// The drives, and the camera that all of them have.
struct Plan {
  RunConfig config;
  CameraChoice camera;
  bool focal_known = true;
  bool focal_searched = false;
  std::vector<CalibrationDrive> drives;
  int frames = 0;
};

/// Its principal point is the image's middle.
Result<CameraPtr> plain_pinhole(double focal_px, int width, int height) {
  return PinholeCamera::create({.fx = focal_px, .fy = focal_px, .cx = 0.5 * (width - 1), .cy = 0.5 * (height - 1)},
                               width, height);
}

double focal_of_view(double fov_deg, int width) {
  return 0.5 * width / std::tan(0.5 * fov_deg * std::numbers::pi / 180.0);
}

/// The camera of --camera or the one that lies with the images; of --fov; or none: its focal length is searched for.
Result<void> choose_start(const CalibrateArguments& a, const SourceArguments& own, const Sequence& sequence,
                          Plan& plan) {
  const bool named = !plan.config.run.camera.empty();
  if (!a.fov_deg && (named || !sequence.calibration_path().empty())) {
    auto camera = choose_camera(own, plan.config.run, sequence);
    if (!camera) return camera.error();
    plan.camera = std::move(*camera);
    return {};
  }
  if (a.fov_deg && named) return bad_input("--fov and --camera: one of them says the focal length");
  plan.focal_known = false;
  plan.focal_searched = !a.fov_deg.has_value();
  constexpr double kAnyFovDeg = 80.0;
  const double fov_deg = a.fov_deg.value_or(kAnyFovDeg);
  auto camera = plain_pinhole(focal_of_view(fov_deg, sequence.width()), sequence.width(), sequence.height());
  if (!camera) return camera.error();
  plan.camera.setup.camera = *camera;
  plan.camera.camera_from = a.fov_deg ? fmt::format("--fov {:g}", *a.fov_deg) : "nothing";
  auto& height_m = plan.camera.setup.height_m;
  if (own.camera_height_m) height_m = own.camera_height_m;
  if (!height_m && plan.config.run.camera_height_m > 0.0) height_m = plan.config.run.camera_height_m;
  if (height_m && !(*height_m > 0.0 && std::isfinite(*height_m))) {
    return bad_input(fmt::format("the camera height is {} m, it must be above 0", *height_m));
  }
  return {};
}

Result<Plan> make_plan(const CalibrateArguments& a) {
  if (a.fov_deg && !(*a.fov_deg >= 20.0 && *a.fov_deg <= 140.0)) {
    return bad_input(fmt::format("--fov {}: must be from 20 to 140 degrees, from left to right", *a.fov_deg));
  }
  Plan plan;
  for (std::size_t k = 0; k < a.sources.size(); ++k) {
    SourceArguments own = a.source;
    own.source = a.sources[k];
    auto config = read_config(own);
    if (!config) return config.error();
    auto sequence = open_drive(config->run);
    if (!sequence) return sequence.error();
    if (k == 0) {
      plan.config = *config;
      if (const auto chosen = choose_start(a, own, **sequence, plan); !chosen) return chosen.error();
    }
    const Camera& camera = *plan.camera.setup.camera;
    if ((*sequence)->width() != camera.width() || (*sequence)->height() != camera.height()) {
      return bad_input(fmt::format("{}: images of {} x {} px, the camera has {} x {}: all drives must be of one camera",
                                   a.sources[k], (*sequence)->width(), (*sequence)->height(), camera.width(),
                                   camera.height()));
    }
    plan.frames += (*sequence)->frame_count();
    plan.drives.push_back({a.sources[k], [source = config->run] { return open_drive(source); }});
  }
  return plan;
}

Result<void> check_output(const CalibrateArguments& a, const Plan& plan) {
  std::vector<std::string> outputs = {a.output};
  if (!plan.camera.setup.vehicle_mask.empty()) outputs.push_back(vehicle_mask_path(a.output));
  std::vector<std::string> inputs = {plan.camera.camera_from, a.source.config_file};
  inputs.insert(inputs.end(), a.sources.begin(), a.sources.end());
  return check_output_files(outputs, inputs, a.force);
}

std::string slope_text(const ScaleSlope& slope) {
  return fmt::format("{:+.1f} +- {:.1f} % per 100 m", 100.0 * slope.per_100m, 100.0 * slope.sd_per_100m);
}

/// What came out, a line each; for the terminal, and as comment in the file.
std::string found_text(const Calibration& calibration) {
  std::string text;
  const auto line = [&text](std::string_view name, const std::string& value) {
    text += fmt::format("{:<20} {}\n", name, value);
  };
  line("seen", fmt::format("{} frames, {:.0f} m, {:.0f} degrees of turning", calibration.frames, calibration.length_m,
                           calibration.turned_deg));
  for (const CalibratedParameter& parameter : calibration.parameters) {
    line(file_name_of(parameter.parameter, *calibration.setup.camera),
         parameter.reason.empty()
             ? fmt::format("{:.6g} -> {:.6g} +- {:.2g}", parameter.before, parameter.after, parameter.sd)
             : fmt::format("{:.6g}, stays: {}", parameter.before, parameter.reason));
  }
  if (calibration.radial_by_tracks.sd > 0.0) {
    const std::string slope =
        calibration.radial_by_slope
            ? fmt::format("{:.6g} +- {:.2g}", calibration.radial_by_slope->value, calibration.radial_by_slope->sd)
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
  if (calibration.adopted && calibration.length_change) {
    line("lengths",
         fmt::format("{:+.2f} % against the old calibration, at the height given", 100.0 * *calibration.length_change));
  }
  return text;
}

Result<Calibration> calibrate_plan(const CalibrateArguments& a, Plan& plan, const CalibrateOptions& options) {
  Progress progress(!a.quiet, plan.frames);
  const CalibrateProgress show = [&progress](const std::string& what, int frames) { progress.show(frames, what); };
  CameraSetup setup = plan.camera.setup;
  setup.height_m = setup.height_m.value_or(kAssumedHeightM);
  if (plan.focal_searched) {
    const auto focal_px = search_focal(plan.drives.front(), setup, plan.config.odometry, options, show);
    if (!focal_px) return focal_px.error();
    auto camera = plain_pinhole(*focal_px, setup.camera->width(), setup.camera->height());
    if (!camera) return camera.error();
    setup.camera = *camera;
    plan.camera.setup.camera = *camera;
  }
  return calibrate(plan.drives, setup, plan.config.odometry, options, show);
}

Result<void> calibrate_and_write(const CalibrateArguments& a) {
  auto plan = make_plan(a);
  if (!plan) return plan.error();
  if (const auto free = check_output(a, *plan); !free) return free;
  if (!plan->camera.setup.height_m) {
    say(fmt::format("nothing says the camera's height: {} m are assumed, and not written", kAssumedHeightM));
  }
  CalibrateOptions options;
  options.free_focal = !plan->focal_known;
  auto calibration = calibrate_plan(a, *plan, options);
  if (!calibration) return calibration.error();
  const std::string found = found_text(*calibration);
  const std::string verdict = fmt::format("{:<20} {}\n", "verdict", calibration->verdict);
  std::string comment = "by groundscale " GROUNDSCALE_VERSION ", from " + plan->camera.camera_from + "\n";
  for (const CalibrationDrive& drive : plan->drives) comment += fmt::format("{:<20} {}\n", "drive", drive.name);
  calibration->setup.height_m = plan->camera.setup.height_m;
  if (const auto written = write_camera_file(a.output, calibration->setup, comment + found + verdict); !written) {
    return written;
  }
  fmt::print("{:<20} {}\n{}{}", "start", plan->camera.camera_from, found, verdict);
  fmt::print("{:<20} {:.0f} s, {:.1f} times one pass of the odometry ({} passes)\n", "time", calibration->total_s,
             calibration->total_s / calibration->odometry_s, calibration->passes);
  fmt::print("{:<20} {}\n", "written to", a.output);
  return {};
}

}  // namespace

void add_calibrate(CLI::App& app, int& exit_status) {
  auto arguments = std::make_shared<CalibrateArguments>();
  CLI::App* command = app.add_subcommand("calibrate", "The camera's distortion and principal row from drives");
  command->add_option("SOURCE", arguments->sources, "KITTI odometry folders, image folders or videos of one camera")
      ->required();
  command->add_option("--fov", arguments->fov_deg, "Degrees from left to right, where there is no calibration");
  add_drive_options(*command, arguments->source);
  command->add_option("--output", arguments->output, "Camera file for the result")->required();
  command->add_flag("--force", arguments->force, "Overwrite the output");
  command->add_flag("--quiet", arguments->quiet, "No progress");
  command->callback([arguments, &exit_status] {
    const auto done = calibrate_and_write(*arguments);
    exit_status = done ? kDone : report_failure(done.error());
  });
}

}  // namespace groundscale
