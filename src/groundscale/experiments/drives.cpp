#include "groundscale/experiments/drives.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "groundscale/experiments/drives_report_internal.hpp"
#include "groundscale/experiments/plot.hpp"
#include "groundscale/experiments/report_parts.hpp"
#include "groundscale/io/files.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::FinishedDrive;

Result<FinishedDrive> finish_drive(const DriveChoice& choice, const DriveOptions& options, const RunSettings& settings,
                                   const ExperimentRequest& request) {
  const fs::path folder = fs::path(request.output) / "drives" / choice.name;
  auto drive = obtain_drive(choice, options, (folder / "drive").string(), request);
  if (!drive) return drive.error();
  auto run = measure_run(*drive, settings, (folder / "run").string(), request);
  if (!run) return run.error();
  return FinishedDrive{choice.name, std::move(*drive), std::move(*run)};
}

Result<ExperimentOutcome> report(const std::vector<FinishedDrive>& drives, std::vector<std::string> problems,
                                 const ExperimentRequest& request) {
  const fs::path output = request.output;
  const Table table = internal::drives_table(drives);
  if (const auto written = write_text((output / "drives.csv").string(), table.csv()); !written) return written.error();
  auto plots = internal::drives_plots(drives);
  if (!plots) return plots.error();
  const bool drawn = write_figures(request.output, *plots, problems);
  ExperimentOutcome outcome;
  outcome.report = (output / "drives.md").string();
  outcome.table = internal::drives_overview(table);
  outcome.problems = problems;
  const std::string text = internal::drives_report(drives, *plots, request, problems, drawn);
  if (const auto written = write_report(outcome.report, text); !written) return written.error();
  return outcome;
}

}  // namespace

Result<ExperimentOutcome> run_drives(const DriveOptions& options, const RunSettings& settings,
                                     const ExperimentRequest& request) {
  if (const auto valid = settings.validate(); !valid) return valid.error();
  const auto choices = choose_drives(options);
  if (!choices) return choices.error();
  if (const auto free = check_experiment_folder(kDrivesName, request); !free) return free.error();
  const auto lock = claim_experiment_folder(kDrivesName, request);
  if (!lock) return lock.error();
  if (!gnuplot_is_there()) request.say("gnuplot can't be run: there will be no figures");

  std::vector<FinishedDrive> drives;
  std::vector<std::string> problems;
  for (const DriveChoice& choice : *choices) {
    auto drive = finish_drive(choice, options, settings, request);
    if (drive) {
      drives.push_back(std::move(*drive));
    } else {
      problems.push_back(fmt::format("drive {}: {}", choice.name, drive.error().message));
    }
  }
  if (!drives.empty()) return report(drives, std::move(problems), request);
  return Error{ErrorCode::kIo, fmt::format("no drive came to its end: {}", fmt::join(problems, "; "))};
}

}  // namespace groundscale
