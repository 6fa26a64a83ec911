#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <numeric>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "drive_source.hpp"
#include "groundscale/estimation/robust.hpp"
#include "groundscale/evaluation/evaluate.hpp"
#include "groundscale/evaluation/pairing.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/odometry/method_comparison.hpp"
#include "groundscale/odometry/run_writer.hpp"
#include "groundscale/report/run_report.hpp"
#include "groundscale/report/sample_frames.hpp"
#include "groundscale/report/scale_report.hpp"
#include "groundscale/road/ground_methods.hpp"
#include "progress.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;

struct ScaleArguments {
  SourceArguments source;
  std::vector<std::string> methods;
  std::string output;
  std::string truth;
  bool force = false;
  bool quiet = false;
};

std::string folder_of(const ScaleArguments& arguments, std::string_view method) {
  return (fs::path(arguments.output) / method).string();
}

/// What a comparison is made of.
struct Drive {
  Sequence& sequence;
  const Camera& camera;
  const std::optional<RoadMasks>& masks;
  MethodComparison& comparison;
  const Trajectory& truth;  ///< Empty where there is none.
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Takes all frames; times and warnings go into the summary.
void carry_out(const Drive& drive, bool quiet, RunSummary& summary, SampleFrames& samples) {
  auto& [sequence, camera, masks, comparison, truth] = drive;
  Progress progress(!quiet, sequence.frame_count());
  const auto start = std::chrono::steady_clock::now();
  double decoding_s = 0.0;
  std::vector<double> frame_ms;
  while (true) {
    const auto frame_start = std::chrono::steady_clock::now();
    const std::optional<Frame> frame = sequence.next();
    if (!frame) break;
    decoding_s += seconds_since(frame_start);
    if (frame->image.empty()) summary.warnings.push_back(fmt::format("frame {}: {}", frame->index, frame->problem));
    comparison.advance(*frame, mask_of(*frame, masks, summary.warnings));
    frame_ms.push_back(1e3 * seconds_since(frame_start));
    samples.take(*frame, comparison.front(), camera, true_step_m(truth, frame->index));
    progress.show(static_cast<int>(frame_ms.size()), "");
  }
  comparison.finish();
  for (const std::string& warning : sequence.warnings()) summary.warnings.push_back(warning);
  summary.wall_s = seconds_since(start);
  const double count = std::max<double>(1.0, static_cast<double>(frame_ms.size()));
  summary.stage_ms.emplace_back("waiting for images", 1e3 * decoding_s / count);
  for (const auto& [stage, seconds] : comparison.front().clock().seconds()) {
    summary.stage_ms.emplace_back(stage, 1e3 * seconds / count);
  }
  if (frame_ms.empty()) return;
  summary.median_ms = median(frame_ms);
  summary.p95_ms = quantile(frame_ms, 0.95);
}

/// The summary of a method's own run: its time is its own, not what all methods have in common.
RunSummary summary_of(const ComparedMethod& method, RunSummary summary) {
  summary.wall_s = summary.median_ms = summary.p95_ms = 0.0;
  const std::vector<double>& times = method.time_ms();
  const double sum_ms = std::accumulate(times.begin(), times.end(), 0.0);
  summary.stage_ms = {{std::string(method.name()), sum_ms / std::max<double>(1.0, static_cast<double>(times.size()))}};
  return summary;
}

/// Whether a folder of a method's name holds a run: what an earlier `scale` wrote.
bool holds_run(const std::string& folder) {
  std::error_code ignored;
  const auto is_there = [&](const char* file) { return fs::is_regular_file(fs::path(folder) / file, ignored); };
  return is_there("online.kitti") && is_there("frames.csv") && is_there("config.yaml") && is_there("summary.json");
}

/// Runs of methods that an earlier `scale` took and this one doesn't; what else lies in their folders stays.
Result<void> remove_other_methods(const ScaleArguments& arguments, const std::vector<PlaneMethod>& methods) {
  for (const PlaneMethod& known : ground_methods()) {
    const auto same = [&known](const PlaneMethod& method) { return method.name == known.name; };
    const std::string folder = folder_of(arguments, known.name);
    if (std::any_of(methods.begin(), methods.end(), same) || !holds_run(folder)) continue;
    // A new run takes the old one's place, and of the new one there are no more than two files.
    if (const auto writer = RunWriter::create(folder, /*force=*/true); !writer) return writer.error();
    std::error_code ignored;
    for (const char* file : {"online.kitti", "online.tum"}) fs::remove(fs::path(folder) / file, ignored);
    fs::remove(folder, ignored);  // which does nothing where something is left in it
  }
  return {};
}

/// What somebody has made of a drive, as a run's folder.
Result<void> write_run(const std::string& folder, const DriveOutcome& outcome, RunSummary summary,
                       const std::string& config_yaml) {
  add_figures(outcome, summary);
  auto writer = RunWriter::create(folder, /*force=*/true);
  if (!writer) return writer.error();
  if (const auto done = writer->write_online(outcome); !done) return done;
  return writer->finish(outcome, summary, config_yaml);
}

/// The run of the odometry that matched the images, one for each method, and the table of all.
Result<void> write(const ScaleArguments& arguments, const RunConfig& config, const Sequence& sequence,
                   const MethodComparison& comparison, const RunSummary& summary) {
  const std::string in_force = config_in_force(config, sequence, summary);
  if (const auto done = write_run(arguments.output, comparison.front(), summary, in_force); !done) return done;
  for (const ComparedMethod& method : comparison.methods()) {
    RunConfig own = config;
    own.odometry.ground.method = method.name();
    const auto done = write_run(folder_of(arguments, method.name()), method, summary_of(method, summary),
                                config_in_force(std::move(own), sequence, summary));
    if (!done) return done;
  }
  return write_text((fs::path(arguments.output) / "methods.csv").string(), methods_csv(comparison.methods()));
}

/// Pages about all of it, from what lies in the folders by now.
Result<void> write_reports(const ScaleArguments& arguments, const MethodComparison& comparison,
                           const SampleFrames& samples) {
  const auto failed = [&arguments](const Error& error) {
    return Error{ErrorCode::kIo, fmt::format("{} is whole but for its report: {}", arguments.output, error.message)};
  };
  const std::string folder = (fs::path(arguments.output) / "samples").string();
  if (const auto done = write_samples(folder, samples.chosen()); !done) return failed(done.error());
  for (const ComparedMethod& method : comparison.methods()) {
    const auto done = write_run_report(folder_of(arguments, method.name()));
    if (!done) return failed(done.error());
  }
  const auto done = write_scale_report(arguments.output);
  return done ? done : failed(done.error());
}

double median_time_ms(const ComparedMethod& method) {
  std::vector<double> times;
  for (const double ms : method.time_ms()) {
    if (ms > 0.0) times.push_back(ms);
  }
  return times.empty() ? 0.0 : median(times);
}

/// A table a method: how often it measured, and why not.
void print_methods(const MethodComparison& comparison) {
  for (const ComparedMethod& method : comparison.methods()) {
    int moving = 0;
    int accepted = 0;
    std::map<std::string, int> refused;
    for (const FrameResult& result : method.results()) {
      if (result.state != FrameState::kMoving) continue;
      ++moving;
      if (result.accepted()) {
        ++accepted;
      } else {
        ++refused[kind_of_reason(result.reason)];
      }
    }
    fmt::print(
        "{}\n  measured  {:>6} of {} moving frames\n  time      {:>6.2f} ms a frame (median), the method alone\n",
        method.name(), accepted, moving, median_time_ms(method));
    std::vector<std::pair<int, std::string>> reasons;
    for (const auto& [reason, count] : refused) reasons.emplace_back(count, reason);
    std::sort(reasons.rbegin(), reasons.rend());
    for (const auto& [count, reason] : reasons) fmt::print("  refused   {:>6} {}\n", count, reason);
  }
}

std::string cells(const std::optional<ScaleErrors>& errors) {
  if (!errors) return fmt::format("{:>8} {:>7} {:>7}", "", "", "");
  return fmt::format("{:>+8.2f} {:>7.2f} {:>7.2f}", 100.0 * errors->bias, 100.0 * errors->spread, 100.0 * errors->p95);
}

/// The methods beside each other, against the truth.
Result<void> print_errors(const ScaleArguments& arguments, const MethodComparison& comparison) {
  fmt::print("\nstep / true step - 1 in %: bias (median), spread (median about it), 95th percentile\n");
  fmt::print("{:<20} {:>8}  {:^24}  {:^24}  {:^24}  {:^24}\n", "", "coverage", "raw", "raw, straights", "raw, turns",
             "filtered online");
  for (const ComparedMethod& method : comparison.methods()) {
    // By now all is written: a failure is none of the input's.
    const auto failed = [&](const Error& error) {
      return Error{ErrorCode::kIo, fmt::format("{} is whole, but can't be evaluated: {}",
                                               folder_of(arguments, method.name()), error.message)};
    };
    const auto paired = pair_drive({.estimate = folder_of(arguments, method.name()), .truth = arguments.truth});
    if (!paired) return failed(paired.error());
    const auto evaluation = evaluate(*paired, kitti_lengths_m());
    if (!evaluation) return failed(evaluation.error());
    const ScaleFigures& raw = *evaluation->raw_scale;
    fmt::print("{:<20} {:>8.1f}  {}  {}  {}  {}\n", method.name(), 100.0 * evaluation->coverage->accepted.value(),
               cells(raw.all), cells(raw.straight), cells(raw.turn), cells(evaluation->online_scale->all));
  }
  return {};
}

Result<void> scale(const ScaleArguments& arguments) {
  RunSummary summary;
  auto config = read_config(arguments.source);
  if (!config) return config.error();
  config->odometry.odometry.mode = OdometryMode::kPairwise;
  const auto methods = choose_methods(arguments.methods);
  if (!methods) return methods.error();
  auto sequence = open_drive(config->run);
  if (!sequence) return sequence.error();
  const auto setup = metric_camera(arguments.source, config->run, **sequence, summary);
  if (!setup) return setup.error();
  const auto truth = open_truth(arguments.truth, **sequence);
  if (!truth) return truth.error();
  const auto masks = open_masks(config->run.road_masks, **sequence);
  if (!masks) return masks.error();
  auto comparison = MethodComparison::create(*setup, config->odometry, *methods);
  if (!comparison) return comparison.error();
  if (const auto free = check_output_folder("--output", arguments.output, arguments.force); !free) return free;
  if (const auto made = make_output_folder("--output", arguments.output); !made) return made;
  if (const auto removed = remove_other_methods(arguments, *methods); !removed) return removed;

  summary.source = config->run.source;
  summary.seed = config->odometry.seed;
  summary.first_frame = (*sequence)->first_frame();
  summary.has_times = (*sequence)->has_times();
  if (!summary.has_times) summary.warnings.emplace_back("the source has no times: 10 frames a second are assumed");
  if (!arguments.truth.empty()) summary.truth = fs::absolute(arguments.truth).string();
  SampleFrames samples((*sequence)->frame_count());
  carry_out({**sequence, *setup->camera, *masks, *comparison, *truth}, arguments.quiet, summary, samples);
  if (const auto done = write(arguments, *config, **sequence, *comparison, summary); !done) return done;
  if (const auto done = write_reports(arguments, *comparison, samples); !done) return done;
  for (const std::string& warning : summary.warnings) say("warning: " + warning);
  print_methods(*comparison);
  return arguments.truth.empty() ? Result<void>() : print_errors(arguments, *comparison);
}

}  // namespace

void add_scale(CLI::App& app, int& exit_status) {
  auto arguments = std::make_shared<ScaleArguments>();
  for (const PlaneMethod& method : ground_methods()) arguments->methods.emplace_back(method.name);
  CLI::App* command = app.add_subcommand("scale", "Several ways to measure the ground on the same matches");
  add_source_options(*command, arguments->source);
  command->add_option("--methods", arguments->methods, "Which (" + ground_method_names() + "); all")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->option_text("NAME,NAME,...");
  command->add_option("--output", arguments->output, "Folder for the results")->required();
  command->add_option("--truth", arguments->truth, "True trajectory; each method is compared with it");
  command->add_flag("--force", arguments->force, "Overwrite the output");
  command->add_flag("--quiet", arguments->quiet, "No progress");
  command->callback([arguments, &exit_status] {
    const auto done = scale(*arguments);
    exit_status = done ? kDone : report_failure(done.error());
  });
}

}  // namespace groundscale
