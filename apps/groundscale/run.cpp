#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "drive_source.hpp"
#include "groundscale/estimation/robust.hpp"
#include "groundscale/evaluation/evaluate.hpp"
#include "groundscale/evaluation/figures.hpp"
#include "groundscale/evaluation/pairing.hpp"
#include "groundscale/io/config.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/sequence.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "groundscale/odometry/odometry.hpp"
#include "groundscale/odometry/run_source.hpp"
#include "groundscale/odometry/run_writer.hpp"
#include "groundscale/odometry/speed_check.hpp"
#include "groundscale/report/overlay.hpp"
#include "groundscale/report/run_report.hpp"
#include "groundscale/report/sample_frames.hpp"
#include "progress.hpp"

namespace groundscale {
namespace {

struct RunArguments {
  SourceArguments source;
  std::string output;
  std::string overlay_folder;
  std::string truth;
  bool no_report = false;
  bool force = false;
  bool quiet = false;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double length_of(const std::vector<FrameResult>& results) {
  double length_m = 0.0;
  for (const FrameResult& result : results) length_m += result.online_step_m;
  return length_m;
}

/// What a drive is made of.
struct Drive {
  Sequence& sequence;
  const Camera& camera;
  const std::optional<RoadMasks>& masks;
  Odometry& odometry;
  const Trajectory& truth;  ///< Empty where there is none.
};

Result<void> carry_out(const Drive& drive, RunWriter& writer, const RunArguments& arguments, RunSummary& summary,
                       SampleFrames& samples) {
  auto& [sequence, camera, masks, odometry, truth] = drive;
  Progress progress(!arguments.quiet, sequence.frame_count());
  const auto start = std::chrono::steady_clock::now();
  std::vector<double> frame_ms;
  double decoding_s = 0.0;
  double samples_s = 0.0;
  std::optional<double> metres;
  while (true) {
    const auto frame_start = std::chrono::steady_clock::now();
    const std::optional<Frame> frame = sequence.next();
    if (!frame) break;
    decoding_s += seconds_since(frame_start);
    if (frame->image.empty()) summary.warnings.push_back(fmt::format("frame {}: {}", frame->index, frame->problem));
    const FrameResult& result = odometry.advance(*frame, mask_of(*frame, masks, summary.warnings));
    if (const auto done = writer.write_online(odometry); !done) return done;
    frame_ms.push_back(1e3 * seconds_since(frame_start));
    const auto samples_start = std::chrono::steady_clock::now();
    if (!arguments.no_report) samples.take(*frame, odometry, camera, true_step_m(truth, frame->index));
    samples_s += seconds_since(samples_start);
    if (!arguments.overlay_folder.empty()) {
      if (const auto done = write_overlay(arguments.overlay_folder, *frame, odometry, camera); !done) return done;
    }
    // Steps from before the scale was known have become metres with it.
    if (odometry.scaled()) metres = metres ? *metres + result.online_step_m : length_of(odometry.results());
    progress.show(static_cast<int>(frame_ms.size()), metres ? fmt::format("{:.1f} m", *metres) : "no scale yet");
  }
  odometry.finish();
  summary.wall_s = seconds_since(start);
  const double count = std::max<double>(1.0, static_cast<double>(frame_ms.size()));
  summary.stage_ms.emplace_back("waiting for images", 1e3 * decoding_s / count);
  for (const auto& [stage, seconds] : odometry.clock().seconds())
    summary.stage_ms.emplace_back(stage, 1e3 * seconds / count);
  if (!arguments.no_report) summary.stage_ms.emplace_back("sample pictures", 1e3 * samples_s / count);
  summary.median_ms = median(frame_ms);
  summary.p95_ms = quantile(frame_ms, 0.95);
  return {};
}

void print_summary(const RunSummary& s, const RunArguments& arguments) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  fmt::print("frames               {:>10}    {} moving, {} still, {} turning in place, {} bridged, {} lost\n", s.frames,
             s.moving, s.still, s.rotating, s.bridged, s.lost);
  fmt::print("length               {:>10.2f} m\n", s.length_m);
  fmt::print("road measured        {:>10}    of {} moving frames\n", s.accepted, s.moving);
  if (s.speed_log)
    fmt::print("scale by speed log   {:>10}    frames, where no road was measured\n", s.speed_log->scaled);
  if (s.slope) {
    fmt::print("drift against road   {:>+10.1f} %    +- {:.1f} % per 100 m before correction; {}\n",
               100.0 * s.slope->per_100m, 100.0 * s.slope->sd_per_100m, calibration_verdict(*s.slope));
  }
  for (const CameraEvent& event : s.camera_changes) {
    std::string values;
    for (const auto& [name, value] : event.values)
      values += fmt::format(" {} {:.6g} +- {:.2g}", name, value.value, value.sd);
    fmt::print("camera refined       {:>10}   {}\n", fmt::format("frame {}", event.frame), values);
  }
  fmt::print("mounting pitch, roll {:>10.2f} {:.2f} deg\n", s.mounting.pitch_rad / kDegree,
             s.mounting.roll_rad / kDegree);
  fmt::print("time a frame         {:>10.1f} ms   median; 95 % below {:.1f} ms\n", s.median_ms, s.p95_ms);
  fmt::print("camera height        {:>10.3f} m    from {}: 1 cm more makes every length {:.2f} % longer\n",
             s.camera_height_m, s.camera_height_from, 1.0 / s.camera_height_m);
  const std::filesystem::path output = arguments.output;
  fmt::print("trajectory           {}\n", (output / "trajectory.kitti").string());
  if (!arguments.no_report) fmt::print("report               {}\n", (output / "report.html").string());
}

/// Found out before anything is written: pictures never fall on what they show, nor on anything else unasked.
Result<void> check_overlay(const RunArguments& arguments, const RunSource& source) {
  namespace fs = std::filesystem;
  const std::string& folder = arguments.overlay_folder;
  if (folder.empty()) return {};
  std::vector<fs::path> inputs = {source.source, source.road_masks};
  for (int k = 0; k < 4; ++k) inputs.push_back(fs::path(source.source) / fmt::format("image_{}", k));
  for (const fs::path& input : inputs) {
    std::error_code ignored;
    if (input.empty() || !fs::is_directory(folder, ignored) || !fs::equivalent(folder, input, ignored)) continue;
    return Error{ErrorCode::kBadInput, fmt::format("--overlay {}: holds the input, another is needed", folder)};
  }
  return check_output_folder("--overlay", folder, arguments.force);
}

/// Found out before the work, where the drive's times are known by then.
Result<void> check_speed_log(const Odometry& odometry, const Sequence& sequence) {
  const SpeedReference* speed = odometry.speed_reference();
  const std::optional<TimeSpan> drive = sequence.time_span();
  return speed != nullptr && drive ? check_overlap(*speed, *drive) : Result<void>();
}

/// The same table as `groundscale evaluate` prints.
Result<void> print_evaluation(const std::string& output, const std::string& truth) {
  // By now all is written: a failure is none of the input's.
  const auto failed = [&output](const Error& error) {
    return Error{ErrorCode::kIo, fmt::format("{} is whole, but can't be evaluated: {}", output, error.message)};
  };
  const PairingRequest request{.estimate = output, .truth = truth};
  const auto paired = pair_drive(request);
  if (!paired) return failed(paired.error());
  const auto evaluation = evaluate(*paired, kitti_lengths_m());
  if (!evaluation) return failed(evaluation.error());
  fmt::print("\n{}", evaluation_table(request, *paired, *evaluation));
  return {};
}

/// Sample pictures and the report, from what lies in the folder by now.
Result<void> report(const std::string& output, const SampleFrames& samples) {
  const auto failed = [&output](const Error& error) {
    return Error{ErrorCode::kIo, fmt::format("{} is whole but for its report: {}", output, error.message)};
  };
  const std::string folder = (std::filesystem::path(output) / "samples").string();
  if (const auto written = write_samples(folder, samples.chosen()); !written) return failed(written.error());
  if (const auto written = write_run_report(output); !written) return failed(written.error());
  return {};
}

Result<void> run(const RunArguments& arguments) {
  RunSummary summary;
  auto config = read_config(arguments.source);
  if (!config) return config.error();
  RunSource& source = config->run;
  auto sequence = open_drive(source);
  if (!sequence) return sequence.error();
  const auto setup = metric_camera(arguments.source, source, **sequence, summary);
  if (!setup) return setup.error();
  const auto truth = open_truth(arguments.truth, **sequence);
  if (!truth) return truth.error();
  const auto masks = open_masks(source.road_masks, **sequence);
  if (!masks) return masks.error();
  auto odometry = make_odometry(*setup, config->odometry);
  if (!odometry) return odometry.error();
  if (const auto fits = check_speed_log(**odometry, **sequence); !fits) return fits;
  if (const auto free = check_overlay(arguments, source); !free) return free;
  auto writer = RunWriter::create(arguments.output, arguments.force);
  if (!writer) return writer.error();
  if (!arguments.overlay_folder.empty()) {
    if (const auto made = make_output_folder("--overlay", arguments.overlay_folder); !made) return made;
  }

  summary.source = source.source;
  summary.seed = config->odometry.seed;
  summary.first_frame = (*sequence)->first_frame();
  summary.has_times = (*sequence)->has_times();
  if (!summary.has_times) summary.warnings.emplace_back("the source has no times: 10 frames a second are assumed");
  if (config->odometry.camera.refine == CameraRefinement::kOnline &&
      config->odometry.odometry.mode == OdometryMode::kPairwise) {
    summary.warnings.emplace_back("camera.refine: online has no effect in pairwise mode");
  }
  if (!arguments.truth.empty()) summary.truth = std::filesystem::absolute(arguments.truth).string();
  const Drive drive{**sequence, *setup->camera, *masks, **odometry, *truth};
  SampleFrames samples((*sequence)->frame_count());
  if (const auto done = carry_out(drive, *writer, arguments, summary, samples); !done) return done;
  for (const std::string& warning : (*sequence)->warnings()) summary.warnings.push_back(warning);
  add_figures(**odometry, summary);
  if (!(*odometry)->scaled())
    summary.warnings.emplace_back("no measurement of the road was accepted: the trajectory has no scale");
  if (const auto done = writer->finish(**odometry, summary, config_in_force(*config, **sequence, summary)); !done) {
    return done;
  }
  if (!arguments.no_report) {
    if (const auto done = report(arguments.output, samples); !done) return done;
  }
  for (const std::string& warning : summary.warnings) say("warning: " + warning);
  print_summary(summary, arguments);
  return arguments.truth.empty() ? Result<void>() : print_evaluation(arguments.output, arguments.truth);
}

}  // namespace

void add_run(CLI::App& app, int& exit_status) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "A metric trajectory from a drive");
  add_source_options(*command, arguments->source);
  command->add_option("--output", arguments->output, "Folder for the results")->required();
  command->add_option("--overlay", arguments->overlay_folder, "Folder for pictures of what was measured in each frame");
  command->add_option("--truth", arguments->truth, "True trajectory; the result is compared with it at the end");
  command->add_flag("--no-report", arguments->no_report, "Neither report.html nor its pictures");
  command->add_flag("--force", arguments->force, "Overwrite the output");
  command->add_flag("--quiet", arguments->quiet, "No progress");
  command->callback([arguments, &exit_status] {
    const auto done = run(*arguments);
    exit_status = done ? kDone : report_failure(done.error());
  });
}

}  // namespace groundscale
