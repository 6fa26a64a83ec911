#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "calibrate_plan.hpp"
#include "calibrate_report.hpp"
#include "commands.hpp"
#include "groundscale/calibration/calibrate.hpp"
#include "groundscale/calibration/focal_search.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/report/calibration_report.hpp"
#include "output_files.hpp"
#include "progress.hpp"

namespace groundscale {
namespace {

std::string report_path(const std::string& camera_file) {
  const std::filesystem::path file(camera_file);
  return (file.parent_path() / (file.stem().string() + "_report.html")).string();
}

Result<void> check_output(const CalibrateArguments& a, const CalibrationPlan& plan) {
  std::vector<std::string> outputs = {a.output, report_path(a.output)};
  if (!plan.camera.setup.vehicle_mask.empty()) outputs.push_back(vehicle_mask_path(a.output));
  std::vector<std::string> inputs = {plan.camera.camera_from, a.source.config_file};
  for (const CalibrationPlan::Drive& drive : plan.drives) {
    inputs.push_back(drive.source);
    if (!a.fov_deg && plan.config.run.camera.empty()) inputs.push_back(drive.calibration);
  }
  return check_output_files(outputs, inputs, a.force);
}

Result<Calibration> calibrate_plan(CalibrationPlan& plan, bool quiet) {
  Progress progress(!quiet, plan.frames());
  const CalibrateProgress show = [&progress](const std::string& what, int frames) { progress.show(frames, what); };
  CalibrateOptions options;
  options.free_focal = !plan.focal_known;
  CameraSetup setup = plan.camera.setup;
  setup.height_m = setup.height_m.value_or(kAssumedHeightM);
  if (*setup.height_m > kUnlikelyHeightM) {
    say(fmt::format("warning: the camera height is {} m: is it given in metres?", *setup.height_m));
  }
  if (plan.focal_searched) {
    const auto focal_px = search_focal(plan.readers.front(), setup, plan.config.odometry, options, show);
    if (!focal_px) return focal_px.error();
    auto camera = plain_pinhole(*focal_px, setup.camera->width(), setup.camera->height());
    if (!camera) return camera.error();
    setup.camera = *camera;
    plan.camera.setup.camera = *camera;
    plan.camera.camera_from = fmt::format("nothing, a focal length of {:.0f} px fits tracks best", *focal_px);
  }
  auto calibration = calibrate(plan.readers, setup, plan.config.odometry, options, show);
  if (calibration) calibration->setup.height_m = plan.camera.setup.height_m;
  return calibration;
}

/// The camera file last: where it is, all of it is.
Result<void> write(const std::string& output, const CalibrationPlan& plan, const Calibration& calibration) {
  const auto report = calibration_report(plan, calibration, output);
  if (const auto written = write_calibration_report(report_path(output), report); !written) return written;
  const CalibrationWords words(plan, calibration);
  const std::string comment = "by groundscale calibrate " GROUNDSCALE_VERSION "\n" + text_of(words.origins()) +
                              text_of(words.parameters()) + text_of(words.evidence()) +
                              text_of({{"verdict", words.verdict()}});
  return write_camera_file(output, calibration.setup, comment);
}

Result<void> calibrate_and_write(const CalibrateArguments& a) {
  auto plan = make_calibration_plan(a);
  if (!plan) return plan.error();
  if (const auto free = check_output(a, *plan); !free) return free;
  if (!plan->config.run.road_masks.empty()) say("warning: run.road_masks: calibrate uses no road masks");
  const auto calibration = calibrate_plan(*plan, a.quiet);
  for (const std::string& warning : *plan->warnings) say("warning: " + warning);
  if (!calibration) return calibration.error();
  if (const auto written = write(a.output, *plan, *calibration); !written) return written;
  const CalibrationWords words(*plan, *calibration);
  fmt::print("{}{}{}", text_of(words.origins()), text_of(words.parameters()), text_of(words.evidence()));
  fmt::print("{:<20} {}\n", "verdict", words.verdict());
  fmt::print("{:<20} {:.0f} s, {:.1f} times one pass of the odometry ({} passes)\n", "time", calibration->total_s,
             calibration->total_s / calibration->odometry_s, calibration->passes);
  fmt::print("{:<20} {}, {}\n", "written to", a.output, report_path(a.output));
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
  command->add_option("--output", arguments->output, "Camera file for the result; a report is written beside it")
      ->required();
  command->add_flag("--force", arguments->force, "Overwrite the output");
  command->add_flag("--quiet", arguments->quiet, "No progress");
  command->callback([arguments, &exit_status] {
    const auto done = calibrate_and_write(*arguments);
    exit_status = done ? kDone : report_failure(done.error());
  });
}

}  // namespace groundscale
