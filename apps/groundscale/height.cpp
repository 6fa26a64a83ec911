#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "drive_source.hpp"
#include "groundscale/calibration/camera_height.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/speed_file.hpp"
#include "groundscale/odometry/odometry.hpp"
#include "output_files.hpp"
#include "progress.hpp"

namespace groundscale {
namespace {

struct HeightArguments {
  SourceArguments source;
  std::string speed, gpx, output;
  std::optional<double> distance_m, from_s, to_s, offset_s;
  double distance_sd_m = 0.0;
  double max_offset_s = 60.0;
  bool force = false;
  bool quiet = false;
};

/// Where nothing is known of the height: a camera behind the windscreen of a car.
constexpr double kAssumedHeightM = 1.5;
/// The region of the road and the gates are in metres: with a height that is further off the odometry runs again.
constexpr double kNearEnough = 0.05;
constexpr int kMostRuns = 3;

Error bad_input(std::string message) { return {ErrorCode::kBadInput, std::move(message)}; }

/// What can be known before the work.
Result<void> check_arguments(const HeightArguments& a) {
  const int given = static_cast<int>(!a.speed.empty()) + static_cast<int>(!a.gpx.empty()) +
                    static_cast<int>(a.distance_m.has_value());
  if (given != 1) return bad_input("one of --speed CSV, --gpx FILE and --distance M must be given");
  if (!a.distance_m) {
    if (a.from_s || a.to_s || a.distance_sd_m != 0.0) {
      return bad_input("--from, --to and --distance-sd belong to --distance");
    }
    if (!(a.max_offset_s >= 0.0 && a.max_offset_s <= 86400.0)) {
      return bad_input(fmt::format("--max-offset {}: must be from 0 to 86400 s", a.max_offset_s));
    }
    if (a.offset_s && !std::isfinite(*a.offset_s)) {
      return bad_input(fmt::format("--offset {}: must be a finite number", *a.offset_s));
    }
    return {};
  }
  if (a.offset_s) return bad_input("--offset belongs to --speed and --gpx");
  if (!(*a.distance_m > 0.0 && std::isfinite(*a.distance_m))) {
    return bad_input(fmt::format("--distance {}: must be a length above 0 m", *a.distance_m));
  }
  if (!(a.distance_sd_m >= 0.0 && std::isfinite(a.distance_sd_m))) {
    return bad_input(fmt::format("--distance-sd {}: must be at least 0 m", a.distance_sd_m));
  }
  for (const auto& [option, time_s] : {std::pair("--from", a.from_s), std::pair("--to", a.to_s)}) {
    if (time_s && !std::isfinite(*time_s)) return bad_input(fmt::format("{} {}: must be a time in s", option, *time_s));
  }
  if (a.from_s && a.to_s && !(*a.from_s < *a.to_s)) {
    return bad_input(fmt::format("--from {} --to {}: the times must rise", *a.from_s, *a.to_s));
  }
  return {};
}

Result<void> check_output(const HeightArguments& a, const RunConfig& config, const CameraChoice& camera) {
  std::vector<std::string> outputs = {a.output};
  if (!camera.setup.vehicle_mask.empty()) outputs.push_back(vehicle_mask_path(a.output));
  return check_output_files(outputs, {a.speed, a.gpx, config.run.source, camera.camera_from, a.source.config_file},
                            a.force);
}

Result<std::optional<SpeedLog>> read_log(const HeightArguments& a) {
  if (a.distance_m) return std::optional<SpeedLog>();
  auto log = a.gpx.empty() ? read_speed_csv(a.speed) : read_gpx(a.gpx);
  if (!log) return log.error();
  if (const auto moves = check_moving(*log); !moves) {
    return bad_input(fmt::format("{}{}: {}", a.speed, a.gpx, moves.error().message));
  }
  return std::optional<SpeedLog>(std::move(*log));
}

/// What the odometry made of the drive.
struct DrivenOnce {
  std::vector<FrameResult> results;
  double frame_s = 0.1;
  bool has_times = true;
};

Result<DrivenOnce> drive_once(const RunConfig& config, const CameraSetup& setup, bool quiet) {
  auto sequence = open_drive(config.run);
  if (!sequence) return sequence.error();
  const auto masks = open_masks(config.run.road_masks, **sequence);
  if (!masks) return masks.error();
  auto odometry = make_odometry(setup, config.odometry);
  if (!odometry) return odometry.error();
  std::vector<std::string> warnings;
  {
    Progress progress(!quiet, (*sequence)->frame_count());
    while (const std::optional<Frame> frame = (*sequence)->next()) {
      if (frame->image.empty()) warnings.push_back(fmt::format("frame {}: {}", frame->index, frame->problem));
      (*odometry)->advance(*frame, mask_of(*frame, *masks, warnings));
      progress.show(static_cast<int>((*odometry)->results().size()),
                    fmt::format("at a camera height of {:.3f} m", *setup.height_m));
    }
  }
  (*odometry)->finish();
  for (const std::string& warning : (*sequence)->warnings()) warnings.push_back(warning);
  for (const std::string& warning : warnings) say("warning: " + warning);
  if ((*odometry)->results().size() < 2) return Error{ErrorCode::kIo, "fewer than two frames could be read"};
  if (!(*odometry)->scaled()) {
    return Error{ErrorCode::kNotGround,
                 fmt::format("no measurement of the road was accepted at a camera height of {:g} m: "
                             "--camera-height starts with another one",
                             *setup.height_m)};
  }
  return DrivenOnce{.results = (*odometry)->results(), .has_times = (*sequence)->has_times()};
}

/// The height that was found, and at which one the odometry ran for it.
struct Found {
  HeightEstimate height = {};
  std::optional<SpeedHeight> speed = std::nullopt;  ///< With a log.
  double run_height_m = 0.0;
  int runs = 0;
  int first_frame = 0, last_frame = 0;
};

Result<Found> compare(const HeightArguments& a, const std::optional<SpeedLog>& log, const DrivenOnce& driven,
                      const StartHeight& start) {
  Found found{.run_height_m = start.height_m};
  found.first_frame = driven.results.front().frame;
  found.last_frame = driven.results.back().frame;
  if (!log) {
    const auto height = height_from_distance({*a.distance_m, a.distance_sd_m, a.from_s, a.to_s}, driven.results, start);
    if (!height) return height.error();
    found.height = *height;
    return found;
  }
  const Odometer odometer(driven.results);
  ClockSearch search{.offset_s = a.offset_s, .max_offset_s = a.max_offset_s};
  search.video_start_s = odometer.first_s() - found.first_frame * odometer.median_interval_s();  // its frame 0
  auto speed = height_from_speed(*log, odometer, start, search);
  if (!speed) return speed.error();
  found.height = speed->height;
  found.speed = std::move(*speed);
  return found;
}

/// Runs the odometry, again with the height that was found where that is far from the one it ran at.
Result<Found> find_height(const HeightArguments& a, const RunConfig& config, CameraSetup setup,
                          const std::optional<SpeedLog>& log, bool known) {
  StartHeight start{.height_m = *setup.height_m, .known = known};
  for (int runs = 1;; ++runs) {
    setup.height_m = start.height_m;
    const auto driven = drive_once(config, setup, a.quiet);
    if (!driven) return driven.error();
    if (!driven->has_times && runs == 1) say("warning: the source has no times: 10 frames a second are assumed");
    auto found = compare(a, log, *driven, start);
    if (!found) return found;
    found->runs = runs;
    const double off = std::log(found->height.ratio);
    if (std::abs(off) < kNearEnough) return found;
    if (runs == kMostRuns) {
      return Error{ErrorCode::kNotConverged,
                   fmt::format("the height doesn't settle: the odometry ran at {:.3f} m, and {:.3f} m came out",
                               start.height_m, found->height.height_m)};
    }
    start = {.height_m = found->height.height_m, .known = true};
  }
}

std::string clock_text(const ClockOffset& clock, double sd_s) {
  if (clock.given) return "as given";
  if (!clock.found) return fmt::format("+- {:.1f} s: the speed varies too little to find it", sd_s);
  return fmt::format("+- {:.2f} s, by the course of the speeds{}", sd_s,
                     clock.aligned ? " (another clock: the starts were laid beside each other first)" : "");
}

/// How the height came about, a line each; for the terminal, and as comment in the file.
std::string found_text(const HeightArguments& a, const Found& found) {
  std::string text;
  const auto line = [&text](const char* name, const std::string& value) {
    text += fmt::format("{:<20} {}\n", name, value);
  };
  if (found.speed) {
    const SpeedHeight& s = *found.speed;
    line("clock of the log",
         fmt::format("{:.2f} s ahead of the video's {}", s.clock.offset_s, clock_text(s.clock, s.offset_sd_s)));
    line("compared", fmt::format("{:.0f} s in motion, {:.1f} m/s on average; {:.0f} s slower than 1.5 m/s left out",
                                 s.compared_s, s.mean_speed_mps, s.slow_s));
    line("agreement",
         fmt::format("speeds within {:.2f} m/s (sd); {} blocks of the drive differ by {:.1f} % beyond that",
                     s.clock.noise.log_mps, s.blocks.size(), 100.0 * s.scatter));
  } else {
    line("distance", fmt::format("{:g} m are {:.2f} m at a camera height of {:.3f} m", *a.distance_m,
                                 *a.distance_m / found.height.ratio, found.run_height_m));
  }
  line("camera height",
       fmt::format("{:.3f} m    +- {:.3f} m ({:.2f} %)", found.height.height_m, found.height.height_sd_m,
                   100.0 * found.height.height_sd_m / found.height.height_m));
  return text;
}

std::string verdict(const Found& found, double start_m, const std::string& start_from) {
  const double change = found.height.height_m / start_m - 1.0;
  const double off_sd = std::abs(found.height.height_m - start_m) / found.height.height_sd_m;
  const std::string lengths =
      fmt::format("every length becomes {:.2f} % {}", 100.0 * std::abs(change), change < 0.0 ? "shorter" : "longer");
  if (start_from.empty()) {
    return fmt::format("the height was not known; {} than at the assumed {:g} m", lengths, start_m);
  }
  if (off_sd < 2.0) {
    return fmt::format("agrees with the {:g} m from {} ({:.1f} standard deviations); {} with the one found", start_m,
                       start_from, off_sd, lengths);
  }
  return fmt::format("the {:g} m from {} are off by {:.1f} standard deviations; {}", start_m, start_from, off_sd,
                     lengths);
}

Result<void> write_camera(const HeightArguments& a, const RunConfig& config, const CameraChoice& camera,
                          const Found& found) {
  CameraSetup setup = camera.setup;
  // To tenths of a millimetre: more would only pretend.
  setup.height_m = std::round(1e4 * found.height.height_m) / 1e4;
  setup.height_sd_m = std::ceil(1e4 * found.height.height_sd_m) / 1e4;
  std::string comment =
      "height_m found by groundscale " GROUNDSCALE_VERSION ", all else as in " + camera.camera_from + "\n";
  comment +=
      fmt::format("{:<20} {}, frames {} to {}\n", "drive", config.run.source, found.first_frame, found.last_frame);
  const std::string log = a.distance_m ? "--distance" : a.speed + a.gpx;
  comment += fmt::format("{:<20} {}\n", "from", log) + found_text(a, found);
  return write_camera_file(a.output, setup, comment);
}

Result<void> find_and_write(const HeightArguments& a) {
  if (const auto fine = check_arguments(a); !fine) return fine;
  const auto config = read_config(a.source);
  if (!config) return config.error();
  if (const std::string& file = config->odometry.scale.speed.file; !file.empty()) {
    return bad_input(
        fmt::format("scale.speed is {}: the height is found from what the ground alone says; --set "
                    "scale.speed= leaves it out",
                    file));
  }
  const auto log = read_log(a);
  if (!log) return log.error();
  auto camera = Result<CameraChoice>(Error{});
  {
    const auto sequence = open_drive(config->run);
    if (!sequence) return sequence.error();
    camera = choose_camera(a.source, config->run, **sequence);
  }
  if (!camera) return camera.error();
  if (const auto free = check_output(a, *config, *camera); !free) return free;
  CameraSetup setup = camera->setup;
  const bool known = setup.height_m.has_value();
  const double start_m = setup.height_m.value_or(kAssumedHeightM);
  setup.height_m = start_m;
  const auto found = find_height(a, *config, setup, *log, known);
  if (!found) return found.error();
  if (*log) {
    const auto gaps = (*log)->gaps();
    if (!gaps.empty()) {
      say(fmt::format(
          "warning: the log has gaps, the first of {} from {:.1f} to {:.1f} s; nothing is taken for known inside",
          gaps.size(), gaps.front().from_s, gaps.front().to_s));
    }
  }
  if (const auto written = write_camera(a, *config, *camera, *found); !written) return written;
  fmt::print("{:<20} {:.3f} m    {}\n", "start", start_m,
             known ? "from " + camera->height_from : "assumed, nothing says a height");
  fmt::print("{:<20} {} to {}    driven {}, last at {:.3f} m\n", "frames", found->first_frame, found->last_frame,
             found->runs == 1 ? "once" : fmt::format("{} times", found->runs), found->run_height_m);
  fmt::print("{}", found_text(a, *found));
  fmt::print("{:<20} {}\n", "verdict", verdict(*found, start_m, known ? camera->height_from : ""));
  fmt::print("{:<20} {}\n", "written to", a.output);
  return {};
}

}  // namespace

void add_height(CLI::App& app, int& exit_status) {
  auto arguments = std::make_shared<HeightArguments>();
  CLI::App* command = app.add_subcommand("height", "The camera's height from speeds, a GPX track or a known distance");
  add_source_options(*command, arguments->source);
  command->add_option("--speed", arguments->speed, "CSV with time_s,speed_mps");
  command->add_option("--gpx", arguments->gpx, "GPX track");
  command->add_option("--distance", arguments->distance_m, "Length of the way in metres, of the whole drive or");
  command->add_option("--from", arguments->from_s, "from this time of the video, in seconds,");
  command->add_option("--to", arguments->to_s, "to this one");
  command->add_option("--distance-sd", arguments->distance_sd_m, "How well the distance is known, in metres");
  command->add_option("--offset", arguments->offset_s, "Seconds that the log's clock is ahead of the video's");
  command->add_option("--max-offset", arguments->max_offset_s, "How far off the clocks may be, in seconds")
      ->capture_default_str();
  command->add_option("--output", arguments->output, "Camera file for the result")->required();
  command->add_flag("--force", arguments->force, "Overwrite the output");
  command->add_flag("--quiet", arguments->quiet, "No progress");
  command->callback([arguments, &exit_status] {
    const auto done = find_and_write(*arguments);
    exit_status = done ? kDone : report_failure(done.error());
  });
}

}  // namespace groundscale
