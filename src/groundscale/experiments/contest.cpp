#include "groundscale/experiments/contest.hpp"

#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "groundscale/evaluation/pairing.hpp"
#include "groundscale/experiments/compared_system.hpp"
#include "groundscale/experiments/contest_report_internal.hpp"
#include "groundscale/experiments/distorted_camera.hpp"
#include "groundscale/experiments/odometry_modes.hpp"
#include "groundscale/experiments/path_plots.hpp"
#include "groundscale/experiments/report_parts.hpp"
#include "groundscale/experiments/work_unit.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::ContestResult;

/// What was asked for, looked at before any work.
struct Plan {
  std::vector<DriveChoice> drives;
  std::vector<std::string> modes;
  std::vector<ComparedSystem> systems;
};

Result<Plan> make_plan(const ContestOptions& options, const RunSettings& settings) {
  if (const auto valid = settings.validate(); !valid) return valid.error();
  auto modes = choose_modes(options.modes);
  if (!modes) return modes.error();
  auto drives = choose_drives(options.drives);
  if (!drives) return drives.error();
  std::vector<std::string> taken = mode_names();
  taken.insert(taken.end(), {"truth", "mean"});
  auto systems = parse_compared(options.compare, taken);
  if (!systems) return systems.error();
  if (const auto fit = check_compared(*systems, *drives); !fit) return fit.error();
  if (options.distortion) {
    for (const DriveChoice& drive : *drives) {
      if (drive.recorded.empty()) continue;
      return internal::bad_input(fmt::format("--distortion: '{}' is a real drive, nothing is rendered", drive.name));
    }
    if (const auto fits = check_distortion(options.drives.preset, *options.distortion); !fits) return fits.error();
  }
  return Plan{std::move(*drives), std::move(*modes), std::move(*systems)};
}

RunSettings with_mode(RunSettings settings, const std::string& mode) {
  for (std::string& assignment : mode_assignments(mode)) settings.assignments.push_back(std::move(assignment));
  return settings;
}

std::string folder_of(const ExperimentRequest& request, const std::string& drive) {
  return (fs::path(request.output) / "drives" / drive).string();
}

/// The truth over the frames of a run.
Result<Trajectory> truth_of(const MeasuredRun& run, const RenderedDrive& drive) {
  auto paired = pair_drive({.estimate = run.folder, .truth = drive.truth()});
  if (!paired) return Error{ErrorCode::kIo, paired.error().message};
  return std::move(paired->truth);
}

/// Runs one mode and takes it into the contest; the first brings the truth with it.
Result<void> add_mode(const std::string& mode, const RunSettings& settings, const ExperimentRequest& request,
                      ContestedDrive& contested) {
  const std::string folder = folder_of(request, contested.name) + "/" + mode;
  request.say(fmt::format("{}: mode {}", contested.name, mode));
  auto run = measure_run(contested.drive, with_mode(settings, mode), folder, request);
  if (!run) return run.error();
  if (contested.truth.size() == 0) {
    auto truth = truth_of(*run, contested.drive);
    if (!truth) return truth.error();
    contested.truth = from_first_pose(*truth);
  }
  auto contender = contend_with(mode, std::move(*run), contested.truth);
  if (!contender) return contender.error();
  contested.contenders.push_back(std::move(*contender));
  return {};
}

/// @return kIo where no mode came to its end; the modes that failed go to the problems.
Result<ContestedDrive> contest_drive(const DriveChoice& choice, const Plan& plan, const ContestOptions& options,
                                     const RunSettings& settings, const ExperimentRequest& request) {
  auto drive = obtain_drive(choice, options.drives, folder_of(request, choice.name) + "/drive", request);
  if (!drive) return drive.error();
  ContestedDrive contested{
      .name = choice.name, .drive = std::move(*drive), .truth = {}, .contenders = {}, .problems = {}};
  for (const std::string& mode : plan.modes) {
    const auto added = add_mode(mode, settings, request, contested);
    if (!added) contested.problems.push_back(fmt::format("drive {}, {}: {}", choice.name, mode, added.error().message));
  }
  if (contested.contenders.empty())
    return Error{ErrorCode::kIo, fmt::format("{}", fmt::join(contested.problems, "; "))};
  for (const ComparedSystem& system : plan.systems) {
    if (compared_file(system, choice.name).empty()) continue;
    auto contender = contend_with(system, choice.name, contested.truth);
    if (contender) {
      contested.contenders.push_back(std::move(*contender));
    } else {
      contested.problems.push_back(
          fmt::format("drive {}, {}: {}", choice.name, system.label(), contender.error().message));
    }
  }
  return contested;
}

/// Whether two runs wrote the same results. @return errors of file_digest.
Result<bool> same_results(const std::string& one, const std::string& other) {
  for (const char* file : {"/trajectory.kitti", "/frames.csv"}) {
    const auto first = file_digest(one + file);
    if (!first) return first.error();
    const auto second = file_digest(other + file);
    if (!second) return second.error();
    if (*first != *second) return false;
  }
  return true;
}

/// The best mode on the first drive, again and again: the first time with the seed that it had, then with the next
/// ones.
Result<internal::SeedRuns> run_seeds(const ContestedDrive& contested, const std::string& mode, int count,
                                     RunSettings settings, const ExperimentRequest& request) {
  internal::SeedRuns seeds{.drive = contested.name, .mode = mode, .runs = {}, .same_bytes = {}};
  const int first = settings.seed.value_or(0);
  for (int k = 0; k < count; ++k) {
    settings.seed = first + k;
    const std::string label = fmt::to_string(*settings.seed);
    const std::string folder = folder_of(request, contested.name) + "/seeds/" + label;
    request.say(fmt::format("{}: mode {}, seed {}", contested.name, mode, label));
    auto run = measure_run(contested.drive, with_mode(settings, mode), folder, request);
    if (!run) return run.error();
    auto contender = contend_with(label, std::move(*run), contested.truth);
    if (!contender) return contender.error();
    seeds.runs.push_back(std::move(*contender));
  }
  const Contender* own = contested.find(mode);
  if (own == nullptr || !own->run || seeds.runs.empty()) return seeds;
  const auto same = same_results(own->run->folder, seeds.runs.front().run->folder);
  if (!same) return same.error();
  seeds.same_bytes = *same;
  return seeds;
}

/// Table, figures and report of what is there.
Result<ExperimentOutcome> report(const Contest& contest, const ContestResult& so_far,
                                 const ExperimentRequest& request) {
  const fs::path output = request.output;
  const Table table = internal::contest_table(so_far.drives);
  if (const auto written = write_text((output / (contest.name + ".csv")).string(), table.csv()); !written) {
    return written.error();
  }
  if (!so_far.seeds.runs.empty()) {
    const auto written = write_text((output / "seeds.csv").string(), internal::seeds_table(so_far.seeds).csv());
    if (!written) return written.error();
  }
  ContestResult result = so_far;
  std::vector<Plot> plots = internal::contest_plots(result.drives);
  const bool drawn = write_figures(request.output, plots, result.problems);
  ExperimentOutcome outcome;
  outcome.report = (output / (contest.name + ".md")).string();
  outcome.table = internal::contest_overview(table);
  for (const Aim& aim : result.aims) outcome.table += fmt::format("\n{}", in_words(aim));
  outcome.problems = result.problems;
  const std::string text = internal::contest_report(contest, result, plots, request, drawn);
  if (const auto written = write_report(outcome.report, text); !written) return written.error();
  return outcome;
}

/// What a system has no file for, so that a mean over fewer drives isn't taken for one over all.
std::vector<std::string> remarks_on(const Plan& plan) {
  std::vector<std::string> remarks;
  for (const ComparedSystem& system : plan.systems) {
    std::vector<std::string> missing;
    for (const DriveChoice& drive : plan.drives) {
      if (compared_file(system, drive.name).empty()) missing.push_back(drive.name);
    }
    if (!missing.empty()) {
      remarks.push_back(fmt::format("{}: no trajectory of {}", system.label(), fmt::join(missing, ", ")));
    }
  }
  return remarks;
}

/// All drives, one after the other, with a report after each that says what is still to come.
Result<ExperimentOutcome> work(const Contest& contest, const Plan& plan, const ContestOptions& options,
                               const RunSettings& settings, const ExperimentRequest& request) {
  const std::string best = best_mode(plan.modes);
  ContestResult result;
  result.remarks = remarks_on(plan);
  std::optional<ExperimentOutcome> outcome;
  for (std::size_t k = 0; k < plan.drives.size(); ++k) {
    const DriveChoice& choice = plan.drives[k];
    auto drive = contest_drive(choice, plan, options, settings, request);
    if (drive) {
      result.problems.insert(result.problems.end(), drive->problems.begin(), drive->problems.end());
      result.drives.push_back(std::move(*drive));
      if (options.seeds > 0 && result.seeds.runs.empty()) {
        auto seeds = run_seeds(result.drives.back(), best, options.seeds, settings, request);
        if (seeds) result.seeds = std::move(*seeds);
        if (!seeds) result.problems.push_back(fmt::format("seeds: {}", seeds.error().message));
      }
    } else {
      result.problems.push_back(fmt::format("drive {}: {}", choice.name, drive.error().message));
    }
    if (result.drives.empty()) continue;
    result.aims = contest.aims(result.drives, best);
    ContestResult so_far = result;
    for (std::size_t later = k + 1; later < plan.drives.size(); ++later) {
      so_far.problems.push_back(fmt::format("drive {}: not done yet", plan.drives[later].name));
    }
    auto reported = report(contest, so_far, request);
    if (!reported) return reported;
    outcome = std::move(*reported);
  }
  if (outcome) return *std::move(outcome);
  return Error{ErrorCode::kIo, fmt::format("no drive came to its end: {}", fmt::join(result.problems, "; "))};
}

}  // namespace

Result<ExperimentOutcome> run_contest(const Contest& contest, const ContestOptions& options,
                                      const RunSettings& settings, const ExperimentRequest& request) {
  const auto plan = make_plan(options, settings);
  if (!plan) return plan.error();
  if (const auto free = check_experiment_folder(contest.name, request); !free) return free.error();
  const auto lock = claim_experiment_folder(contest.name, request);
  if (!lock) return lock.error();
  if (!gnuplot_is_there()) request.say("gnuplot can't be run: there will be no figures");
  ContestOptions complete = options;
  RunSettings run = settings;
  if (options.distortion) {
    const auto cameras =
        write_distorted_cameras(options.drives.preset, *options.distortion, request.output + "/cameras");
    if (!cameras) return cameras.error();
    complete.drives.camera = cameras->rendered;
    run.camera = cameras->believed;
  }
  return work(contest, *plan, complete, run, request);
}

}  // namespace groundscale
