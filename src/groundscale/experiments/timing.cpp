#include "groundscale/experiments/timing.hpp"

#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "groundscale/experiments/method_choice.hpp"
#include "groundscale/experiments/rendered_drive.hpp"
#include "groundscale/experiments/report_parts.hpp"
#include "groundscale/experiments/timing_results_internal.hpp"
#include "groundscale/experiments/work_unit.hpp"
#include "groundscale/io/files.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::Timings;

/// What is to be done, all of it valid.
struct Plan {
  std::vector<PlaneMethod> methods;
  OdometryOptions odometry;
  std::vector<DriveChoice> drives;
};

/// What came of it.
struct Done {
  Timings timings;
  std::vector<std::string> drives;  ///< In words, with their commands.
  std::vector<std::string> processors;
  std::vector<std::string> problems;
};

Result<Plan> make_plan(const TimingOptions& options) {
  Plan plan;
  auto methods = choose_ground_methods(options.methods, {});
  if (!methods) return methods.error();
  plan.methods = std::move(*methods);
  auto odometry = assigned_options({}, options.assignments);
  if (!odometry) return odometry.error();
  plan.odometry = std::move(*odometry);
  DriveOptions drives = options.drives;
  if (drives.sequences.empty() && drives.kitti.empty() && drives.clips.empty()) drives.sequences = {"city:100"};
  drives.default_sequences = {"07:100"};
  auto choices = choose_drives(drives);
  if (!choices) return choices.error();
  plan.drives = std::move(*choices);
  return plan;
}

Result<std::string> key_of(const RenderedDrive& drive, const Plan& plan, const TimingOptions& options,
                           const std::string& program) {
  const auto digest = file_digest(program);
  if (!digest) return digest.error();
  std::string methods;
  for (const PlaneMethod& method : plan.methods) methods.append(" ").append(method.name);
  return fmt::format("{}, program {}\ntimes of{}\n{}\n{}", program_version(), *digest, methods,
                     shell_line(options.assignments), drive.key);
}

Result<void> do_drive(const DriveChoice& choice, const Plan& plan, const TimingOptions& options,
                      const ExperimentRequest& request, Done& done) {
  const fs::path folder = fs::path(request.output) / "drives" / choice.name;
  const auto drive = obtain_drive(choice, options.drives, (folder / "drive").string(), request);
  if (!drive) return drive.error();
  const auto key = key_of(*drive, plan, options, request.program);
  if (!key) return key.error();
  const WorkUnit unit((folder / "times").string(), *key);
  const auto worked = unit.complete(request.force, [&]() -> Result<void> {
    request.say(fmt::format("{}: timing {} frames", choice.name, choice.frames));
    Timings timings;
    if (const auto added = internal::add_timings(*drive, plan.methods, plan.odometry, timings); !added) return added;
    if (const auto written = internal::write_timings(timings, unit.folder()); !written) return written;
    return write_text(unit.folder() + "/processor.txt", processor_name() + "\n");
  });
  if (!worked) return worked;
  const auto timings = internal::read_timings(unit.folder());
  if (!timings) return timings.error();
  const auto processor = read_text(unit.folder() + "/processor.txt");
  if (!processor) return Error{ErrorCode::kIo, processor.error().message};
  internal::append(*timings, done.timings);
  done.processors.push_back(processor->substr(0, processor->find('\n')));
  done.drives.push_back(drive->command.empty() ? fmt::format("drive {} in {}", choice.name, drive->folder)
                                               : drive->command);
  return {};
}

Result<ExperimentOutcome> report(Done done, const ExperimentRequest& request) {
  const fs::path output = request.output;
  const Table table = internal::timing_table(done.timings);
  if (const auto written = write_text((output / fmt::format("{}.csv", kTimingName)).string(), table.csv()); !written) {
    return written.error();
  }
  std::vector<Plot> plots = {internal::timing_plot(done.timings)};
  const bool drawn = write_figures(request.output, plots, done.problems);
  ExperimentOutcome outcome;
  outcome.report = (output / fmt::format("{}.md", kTimingName)).string();
  const std::string findings = in_words(internal::timing_findings(done.timings));
  std::vector<std::string> aims;
  for (const Aim& aim : internal::timing_aims(done.timings)) aims.push_back(in_words(aim));
  outcome.table = internal::timing_overview(table) + "\n" + findings + "\n" + bullet_list(aims);
  outcome.problems = done.problems;
  std::string text = fmt::format("# Experiment `{}`: {}\n\n    {}\n\n{}. ", kTimingName, kTimingSummary,
                                 request.command, program_version());
  text += fmt::format(
      "CPU time of the one thread at work, on: {}. Every method is handed the same observations; a frame that it "
      "refuses counts. Full precision: `{}.csv`.\n\n",
      distinct(done.processors), kTimingName);
  if (!done.problems.empty()) text += "**Not complete:**\n\n" + bullet_list(done.problems);
  text += "## Overview\n\n" + internal::timing_overview(table) + "\n## The paper's findings\n\n" + findings +
          "\n## Aims\n\n" + bullet_list(aims) + figures_section(plots, drawn) + "## Step by step\n\n";
  for (const std::string& drive : done.drives) text += fmt::format("    {}\n", drive);
  if (const auto written = write_report(outcome.report, text); !written) return written.error();
  return outcome;
}

}  // namespace

Result<ExperimentOutcome> run_timing(const TimingOptions& options, const ExperimentRequest& request) {
  const auto plan = make_plan(options);
  if (!plan) return plan.error();
  if (const auto free = check_experiment_folder(kTimingName, request); !free) return free.error();
  const auto lock = claim_experiment_folder(kTimingName, request);
  if (!lock) return lock.error();
  Done done;
  for (const DriveChoice& choice : plan->drives) {
    const auto worked = do_drive(choice, *plan, options, request, done);
    if (!worked) done.problems.push_back(fmt::format("drive {}: {}", choice.name, worked.error().message));
  }
  const bool measured = !done.timings.rows.empty() && !done.timings.rows.front().ms.empty();
  if (measured) return report(std::move(done), request);
  return Error{ErrorCode::kIo, done.problems.empty()
                                   ? "no frame of the drives moved"
                                   : fmt::format("no drive came to its end: {}", fmt::join(done.problems, "; "))};
}

}  // namespace groundscale
