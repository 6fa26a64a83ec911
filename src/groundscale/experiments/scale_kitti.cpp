#include "groundscale/experiments/scale_kitti.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/evaluation/pairing.hpp"
#include "groundscale/experiments/method_choice.hpp"
#include "groundscale/experiments/report_parts.hpp"
#include "groundscale/experiments/scale_kitti_report_internal.hpp"
#include "groundscale/experiments/source_drive.hpp"
#include "groundscale/experiments/work_unit.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/report/scale_report.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::ScaleKittiResult;
using internal::ScaleRow;
using internal::ScaleSetting;

/// One call of `groundscale scale`.
struct Pass {
  std::string name;    ///< Of its folder.
  std::string region;  ///< "fixed" or "path".
  std::string filter;  ///< As a ScaleSetting has it,
  std::string kind;    ///< and as the configuration does.
  std::vector<std::string> methods;
};

std::vector<Pass> passes_of(const std::vector<PlaneMethod>& methods) {
  std::vector<std::string> all;
  std::vector<std::string> scale_alone;
  std::vector<std::string> whole_plane;
  for (const PlaneMethod& method : methods) {
    all.emplace_back(method.name);
    (method.scale_alone ? scale_alone : whole_plane).emplace_back(method.name);
  }
  std::vector<Pass> passes;
  for (const char* region : {"fixed", "path"}) {
    passes.push_back({fmt::format("{}-model", region), region, "model", "model", all});
    if (!whole_plane.empty()) {
      passes.push_back({fmt::format("{}-paper", region), region, "paper", "paper", whole_plane});
    }
    if (!scale_alone.empty()) {
      passes.push_back({fmt::format("{}-paper-scale", region), region, "paper", "paper_scale", scale_alone});
    }
  }
  return passes;
}

/// The paper shows its region in a picture and doesn't say its corners. This one is a rectangle as that of Song and
/// Chandraker 2014: the middle third of the columns, from the row where a level road is 15 m away (0.7 of the height on
/// KITTI) down to the last one.
Result<std::string> fixed_region(const RenderedDrive& drive) {
  const auto source = open_source_drive(drive.folder, "", 0);
  if (!source) return source.error();
  const CameraSetup& setup = source->setup;
  const Mounting mounting{setup.pitch_rad.value_or(0.0), setup.roll_rad.value_or(0.0), setup.yaw_rad.value_or(0.0)};
  constexpr double kFarM = 15.0;
  const auto far =
      setup.camera->project(kFarM * mounting.forward_in_cam() + *setup.height_m * mounting.normal_in_cam());
  const double last_row = setup.camera->height() - 1.0;
  if (!far || !(far->y() < last_row))
    return internal::bad_input(fmt::format("{}: the road {} m ahead isn't in the image", drive.folder, kFarM));
  const double left = std::round(setup.camera->width() / 3.0);
  const double right = std::round(2.0 * setup.camera->width() / 3.0);
  const double top = std::max(0.0, std::round(far->y()));
  return fmt::format("road.region.polygon_px=[{0}, {2}, {1}, {2}, {1}, {3}, {0}, {3}]", left, right, top, last_row);
}

Result<std::vector<std::string>> pass_arguments(const Pass& pass, const RenderedDrive& drive,
                                                const RunSettings& settings) {
  std::vector<std::string> arguments = {"scale", drive.folder, "--methods",
                                        fmt::format("{}", fmt::join(pass.methods, ","))};
  const auto set = [&arguments](const std::string& assignment) {
    arguments.insert(arguments.end(), {"--set", assignment});
  };
  std::error_code ignored;
  const std::string config = drive.folder + "/config.yaml";
  if (!drive.real && fs::is_regular_file(config, ignored)) arguments.insert(arguments.end(), {"--config", config});
  for (const std::string& assignment : settings.assignments) set(assignment);
  set("ground.filter=" + pass.kind);
  if (pass.kind == "paper") set("ground.plane.start=predicted");
  if (pass.region == "fixed") {
    const auto region = fixed_region(drive);
    if (!region) return region.error();
    set(*region);
  }
  if (settings.seed) arguments.insert(arguments.end(), {"--seed", fmt::to_string(*settings.seed)});
  if (drive.frames > 0) arguments.insert(arguments.end(), {"--frames", fmt::to_string(drive.frames)});
  return arguments;
}

/// Rows of what a pass has left in its folder.
Result<std::vector<ScaleRow>> read_pass(const Pass& pass, const std::string& folder, const RenderedDrive& drive) {
  const auto times = read_method_times(folder + "/methods.csv");
  if (!times) return Error{ErrorCode::kIo, times.error().message};
  std::vector<ScaleRow> rows;
  for (const std::string& method : pass.methods) {
    const auto paired = pair_drive({.estimate = fmt::format("{}/{}", folder, method), .truth = drive.truth()});
    if (!paired) return Error{ErrorCode::kIo, paired.error().message};
    const auto evaluation = evaluate(*paired, kitti_lengths_m());
    if (!evaluation) return Error{ErrorCode::kIo, evaluation.error().message};
    ScaleRow row{.drive = drive.name, .real = drive.real, .setting = {pass.region, pass.filter}, .method = method};
    if (evaluation->coverage->accepted.of > 0) row.coverage = evaluation->coverage->accepted.value();
    const auto time = std::find_if(times->begin(), times->end(), [&](const auto& one) { return one.method == method; });
    if (time != times->end() && !time->time_ms.empty()) row.time_ms = median(time->time_ms);
    row.scale = *evaluation->online_scale;
    rows.push_back(row);
    // Unfiltered figures are those of the measurements that our filter's pass has accepted.
    if (pass.filter != "model") continue;
    row.setting.filter = "none";
    row.scale = *evaluation->raw_scale;
    rows.push_back(std::move(row));
  }
  return rows;
}

Result<void> add_pass(const Pass& pass, const RenderedDrive& drive, const RunSettings& settings,
                      const ExperimentRequest& request, ScaleKittiResult& result) {
  auto arguments = pass_arguments(pass, drive, settings);
  if (!arguments) return arguments.error();
  const std::string folder = (fs::path(request.output) / "drives" / drive.name / pass.name).string();
  const auto digest = file_digest(request.program);
  if (!digest) return digest.error();
  const std::string key =
      fmt::format("{}, program {}\n{}\n{}", program_version(), *digest, shell_line(*arguments), drive.key);
  arguments->insert(arguments->end(), {"--output", folder});
  result.commands.push_back(step_command(*arguments));
  if (request.quiet) arguments->emplace_back("--quiet");
  const auto done = WorkUnit(folder, key).complete(request.force, [&]() -> Result<void> {
    request.say(fmt::format("{}: {}", drive.name, pass.name));
    const auto process = run_step(request, *arguments);
    return process ? Result<void>() : process.error();
  });
  if (!done) return done;
  auto rows = read_pass(pass, folder, drive);
  if (!rows) return rows.error();
  result.rows.insert(result.rows.end(), rows->begin(), rows->end());
  return {};
}

Result<ExperimentOutcome> report(ScaleKittiResult result, const ExperimentRequest& request) {
  const fs::path output = request.output;
  const auto written = write_text((output / "scale-kitti.csv").string(), internal::scale_table(result.rows).csv());
  if (!written) return written.error();
  std::vector<Plot> plots = internal::scale_plots(result);
  const bool drawn = write_figures(request.output, plots, result.problems);
  ExperimentOutcome outcome;
  outcome.report = (output / "scale-kitti.md").string();
  outcome.table = internal::scale_overview(result);
  outcome.problems = result.problems;
  const std::string text = internal::scale_kitti_report(result, plots, request, drawn);
  if (const auto done = write_report(outcome.report, text); !done) return done.error();
  return outcome;
}

}  // namespace

Result<ExperimentOutcome> run_scale_kitti(const ScaleKittiOptions& options, const RunSettings& settings,
                                          const ExperimentRequest& request) {
  if (const auto valid = settings.validate(); !valid) return valid.error();
  const auto methods = choose_ground_methods(options.methods, {});
  if (!methods) return methods.error();
  const auto choices = choose_drives(options.drives);
  if (!choices) return choices.error();
  if (const auto free = check_experiment_folder(kScaleKittiName, request); !free) return free.error();
  const auto lock = claim_experiment_folder(kScaleKittiName, request);
  if (!lock) return lock.error();

  ScaleKittiResult result;
  std::optional<ExperimentOutcome> outcome;
  for (const DriveChoice& choice : *choices) {
    const std::string folder = (fs::path(request.output) / "drives" / choice.name / "drive").string();
    const auto drive = obtain_drive(choice, options.drives, folder, request);
    if (!drive) {
      result.problems.push_back(fmt::format("drive {}: {}", choice.name, drive.error().message));
      continue;
    }
    for (const Pass& pass : passes_of(*methods)) {
      const auto added = add_pass(pass, *drive, settings, request, result);
      if (!added)
        result.problems.push_back(fmt::format("drive {}, {}: {}", choice.name, pass.name, added.error().message));
    }
    result.drives.push_back(*drive);
    if (result.rows.empty()) continue;
    auto reported = report(result, request);
    if (!reported) return reported;
    outcome = std::move(*reported);
  }
  if (outcome) return *std::move(outcome);
  return Error{ErrorCode::kIo, fmt::format("no drive came to its end: {}", fmt::join(result.problems, "; "))};
}

}  // namespace groundscale
