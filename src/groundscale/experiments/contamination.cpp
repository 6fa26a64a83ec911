#include "groundscale/experiments/contamination.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "groundscale/experiments/contamination_records_internal.hpp"
#include "groundscale/experiments/method_choice.hpp"
#include "groundscale/experiments/report_parts.hpp"
#include "groundscale/experiments/work_unit.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::bad_input;
using internal::ContaminationRecord;

constexpr double kPercent = 100.0;

/// What is to be done, all of it valid.
struct Plan {
  std::vector<PlaneMethod> methods;
  std::vector<double> shares;
  std::vector<DriveChoice> drives;
  PairWalkOptions walk;
};

/// What came of it.
struct Done {
  std::vector<ContaminationRecord> records;
  std::vector<std::string> commands;  ///< That render the drives.
  std::vector<std::string> problems;
};

Result<Plan> make_plan(const ContaminationOptions& options) {
  Plan plan;
  auto methods = choose_ground_methods(options.methods, {});
  if (!methods) return methods.error();
  plan.methods = std::move(*methods);
  const auto odometry = assigned_options({}, options.assignments);
  if (!odometry) return odometry.error();
  if (!odometry->road.region.polygon_px.empty()) {
    return bad_input("--set road.region.polygon_px: has no place here, the region is shifted in metres");
  }
  plan.walk = {.odometry = *odometry, .true_motion = options.true_motion};
  for (const double share : options.shares_percent) {
    const double wanted = share / kPercent;
    if (std::find(plan.shares.begin(), plan.shares.end(), wanted) == plan.shares.end()) plan.shares.push_back(wanted);
  }
  DriveOptions drives = options.drives;
  drives.default_sequences = {"07:100"};
  if (drives.sequences.empty() && drives.kitti.empty()) drives.sequences = {"straight:100", "city:60"};
  auto choices = choose_drives(drives);
  if (!choices) return choices.error();
  plan.drives = std::move(*choices);
  return plan;
}

Result<std::string> key_of(const RenderedDrive& drive, const Plan& plan, const ContaminationOptions& options,
                           const std::string& program) {
  const auto digest = file_digest(program);
  if (!digest) return digest.error();
  std::string methods;
  for (const PlaneMethod& method : plan.methods) methods.append(" ").append(method.name);
  return fmt::format("{}, program {}\ncontamination of {};{}; true motion {}\n{}\n{}", program_version(), *digest,
                     fmt::join(plan.shares, ","), methods, plan.walk.true_motion, shell_line(options.assignments),
                     drive.key);
}

Result<void> do_drive(const DriveChoice& choice, const Plan& plan, const ContaminationOptions& options,
                      const ExperimentRequest& request, Done& done) {
  const fs::path folder = fs::path(request.output) / "drives" / choice.name;
  DriveOptions drives = options.drives;
  drives.road_masks = true;
  const auto drive = obtain_drive(choice, drives, (folder / "drive").string(), request);
  if (!drive) return drive.error();
  const auto key = key_of(*drive, plan, options, request.program);
  if (!key) return key.error();
  const WorkUnit unit((folder / "pairs").string(), *key);
  const auto worked = unit.complete(request.force, [&]() -> Result<void> {
    request.say(fmt::format("{}: measuring {} frames", choice.name, choice.frames));
    const auto records = internal::measure_contamination(*drive, plan.methods, plan.shares, plan.walk);
    return records ? internal::write_records(*records, unit.folder()) : Result<void>(records.error());
  });
  if (!worked) return worked;
  auto records = internal::read_records(unit.folder());
  if (!records) return records.error();
  done.records.insert(done.records.end(), records->begin(), records->end());
  done.commands.push_back(drive->command);
  return {};
}

std::string report_text(const Done& done, const Plan& plan, const ExperimentRequest& request,
                        const std::string& overview) {
  std::string text = fmt::format("# Experiment `{}`: {}\n\n    {}\n\n{}. ", kContaminationName, kContaminationSummary,
                                 request.command, program_version());
  const RegionOptions& strip = plan.walk.odometry.road.region;
  text += fmt::format(
      "R and t {}. The fixed region is a strip of {:g} m from {:g} to {:g} m ahead, shifted sideways until the wanted "
      "share of its pixels isn't road. The scale comes from the camera's nominal height; gates and filters are left "
      "aside. Every pair alone: `pairs.csv`.\n\n",
      plan.walk.true_motion ? "are true" : "come from the matches", 2.0 * strip.half_width_m, strip.near_m,
      strip.far_m);
  if (!done.problems.empty()) text += "**Not complete:**\n\n" + bullet_list(done.problems);
  const Table table = internal::contamination_table(done.records);
  return text + "## Overview\n\n" + overview + "\n## All figures\n\n" +
         table.markdown({"region", "share", "region_share", "method", "pairs", "coverage", "bias", "median", "p95"}) +
         "\n";
}

Result<ExperimentOutcome> report(Done done, const Plan& plan, const ExperimentRequest& request) {
  const fs::path output = request.output;
  ExperimentOutcome outcome;
  outcome.report = (output / fmt::format("{}.md", kContaminationName)).string();
  const std::pair<std::string, Table> tables[] = {
      {fmt::format("{}.csv", kContaminationName), internal::contamination_table(done.records)},
      {"pairs.csv", internal::records_table(done.records)}};
  for (const auto& [name, table] : tables) {
    if (const auto written = write_text((output / name).string(), table.csv()); !written) return written.error();
  }
  std::vector<Plot> plots = internal::contamination_plots(done.records);
  const bool drawn = write_figures(request.output, plots, done.problems);
  for (const std::string_view region : {internal::kWholeRegion, internal::kPathRegion, internal::kRoadMask}) {
    outcome.table += internal::contamination_overview(done.records, region) + "\n";
  }
  outcome.problems = done.problems;
  std::string text = report_text(done, plan, request, outcome.table) + figures_section(plots, drawn);
  text += "## Step by step\n\n";
  for (const std::string& command : done.commands) text += fmt::format("    {}\n", command);
  if (const auto written = write_report(outcome.report, text); !written) return written.error();
  return outcome;
}

}  // namespace

Result<ExperimentOutcome> run_contamination(const ContaminationOptions& options, const ExperimentRequest& request) {
  const auto plan = make_plan(options);
  if (!plan) return plan.error();
  if (const auto free = check_experiment_folder(kContaminationName, request); !free) return free.error();
  const auto lock = claim_experiment_folder(kContaminationName, request);
  if (!lock) return lock.error();
  Done done;
  for (const DriveChoice& choice : plan->drives) {
    const auto worked = do_drive(choice, *plan, options, request, done);
    if (!worked) done.problems.push_back(fmt::format("drive {}: {}", choice.name, worked.error().message));
  }
  if (!done.records.empty()) return report(std::move(done), *plan, request);
  return Error{ErrorCode::kIo, done.problems.empty()
                                   ? "no pair of frames reached any of the shares"
                                   : fmt::format("no drive came to its end: {}", fmt::join(done.problems, "; "))};
}

}  // namespace groundscale
