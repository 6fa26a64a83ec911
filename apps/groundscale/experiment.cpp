#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "groundscale/experiments/calibration.hpp"
#include "groundscale/experiments/contamination.hpp"
#include "groundscale/experiments/drives.hpp"
#include "groundscale/experiments/experiment.hpp"
#include "groundscale/experiments/matching.hpp"
#include "groundscale/experiments/realism.hpp"
#include "groundscale/experiments/scale_kitti.hpp"
#include "groundscale/experiments/synthetic.hpp"
#include "groundscale/experiments/timing.hpp"
#include "groundscale/experiments/vo_kitti.hpp"

namespace groundscale {
namespace {

/// Options that every experiment has.
void add_common(CLI::App& command, ExperimentRequest& request) {
  command
      .add_option("--output", request.output, "Folder for all that it writes; one of the same experiment is resumed")
      ->required();
  command.add_flag("--force", request.force, "Write into a folder that holds something else; redo what is done");
  command.add_flag("--quiet", request.quiet, "No progress");
}

/// An option that takes values with commas between them, `form` of them.
template <class T>
CLI::Option* add_list(CLI::App& command, const std::string& name, std::vector<T>& values, const std::string& help,
                      const std::string& form) {
  return command.add_option(name, values, help)->delimiter(',')->allow_extra_args(false)->option_text(form);
}

void add_assignments(CLI::App& command, std::vector<std::string>& assignments, const std::string& help) {
  command.add_option("--set", assignments, help)->expected(1)->take_all();
}

/// Poses of KITTI odometry to render drives along.
void add_kitti_poses(CLI::App& command, std::string& folder) {
  command
      .add_option("--kitti", folder, "Folder with KITTI odometry's poses/NN.txt and times; built-in routes without it")
      ->option_text("PATH");
}

/// Which drives, of those that leave the choice.
void add_choice(CLI::App& command, DriveOptions& drives, const std::string& which) {
  add_list(command, "--sequences", drives.sequences, "Which drives, NAME or NAME:FRAMES, or all (" + which + ")",
           "NAME,NAME,...");
  command.add_option("--frames", drives.frames, "At most so many frames of each drive")->check(CLI::Range(2, 1000000));
}

void add_threads(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "For rendering; the images are the same with any number")
      ->check(CLI::PositiveNumber);
}

void add_preset(CLI::App& command, DriveOptions& drives) {
  command.add_option("--preset", drives.preset, "Camera and its place on the vehicle");
}

/// Options of those that render drives and run on them.
void add_drive_settings(CLI::App& command, DriveOptions& drives, RunSettings& settings) {
  command.add_option("--seed", drives.seed, "Of world, vehicle, sensor and run")->check(CLI::NonNegativeNumber);
  add_threads(command, drives.threads);
  add_assignments(command, settings.assignments, "KEY=VALUE of the run's configuration");
}

/// Options of those that render drives and look at pairs of frames themselves.
void add_walk_settings(CLI::App& command, DriveOptions& drives, std::vector<std::string>& assignments) {
  add_preset(command, drives);
  command.add_option("--seed", drives.seed, "Of world, vehicle and sensor")->check(CLI::NonNegativeNumber);
  add_threads(command, drives.threads);
  add_assignments(command, assignments, "KEY=VALUE of the odometry's configuration");
}

/// Drives that are there, or simulated in their place.
void add_recorded_or_simulated(CLI::App& command, DriveOptions& drives, bool& simulate) {
  command
      .add_option("--kitti", drives.kitti,
                  "KITTI odometry: poses/NN.txt and times; sequences/NN with images are real drives, others simulated. "
                  "Built-in routes without it")
      ->option_text("PATH");
  command.add_option("--clips", drives.clips, "Real drives instead: NN/image_0 and NN/poses.txt")->option_text("PATH");
  command.add_flag("--simulate", simulate, "Simulate those of --kitti that have images, too");
  add_preset(command, drives);
}

int finish(const Result<ExperimentOutcome>& outcome) {
  if (!outcome) return report_failure(outcome.error());
  fmt::print("{}\nreport  {}\n", outcome->table, outcome->report);
  for (const std::string& problem : outcome->problems) fmt::print(stderr, "groundscale: {}\n", problem);
  return outcome->problems.empty() ? kDone : kFailedOnTheWay;
}

/// Before the work: what was typed, and where to say what is being done.
void prepare(ExperimentRequest& request) {
  request.command = command_of_this_process();
  if (request.quiet) return;
  request.say = [](std::string_view line) { fmt::print(stderr, "{}\n", line); };
}

void add_drives(CLI::App& parent, int& exit_status) {
  struct Arguments {
    ExperimentRequest request;
    DriveOptions drives;
    RunSettings settings;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = parent.add_subcommand(kDrivesName, kDrivesSummary);
  add_common(*command, arguments->request);
  add_kitti_poses(*command, arguments->drives.kitti);
  add_choice(*command, arguments->drives, "default 06,07,10,00:1501, or all routes");
  add_preset(*command, arguments->drives);
  add_drive_settings(*command, arguments->drives, arguments->settings);
  command->callback([arguments, &exit_status] {
    prepare(arguments->request);
    arguments->settings.seed = arguments->drives.seed;
    exit_status = finish(run_drives(arguments->drives, arguments->settings, arguments->request));
  });
}

void add_realism(CLI::App& parent, int& exit_status) {
  struct Arguments {
    ExperimentRequest request;
    RealismOptions options;
    RunSettings settings;
  };
  const auto arguments = std::make_shared<Arguments>();
  RealismOptions& options = arguments->options;
  CLI::App* command = parent.add_subcommand(kRealismName, kRealismSummary);
  add_common(*command, arguments->request);
  command
      ->add_option("--clips", options.clips,
                   "Folder with real drives: NN/image_0, NN/calib.txt, and NN/poses.txt and NN/times.txt with a row an "
                   "image")
      ->required()
      ->option_text("PATH");
  command
      ->add_option("--kitti", options.drives.kitti, "Folder with the whole poses/NN.txt and times of their sequences")
      ->required()
      ->option_text("PATH");
  add_list(*command, "--sequences", options.drives.sequences, "Which (default 00,07)", "NN,NN,...");
  command->add_option("--pair", options.pair_frame, "Frame that is shown as a pair of pictures (100)")
      ->check(CLI::NonNegativeNumber);
  add_drive_settings(*command, options.drives, arguments->settings);
  command->callback([arguments, &exit_status] {
    prepare(arguments->request);
    arguments->settings.seed = arguments->options.drives.seed;
    exit_status = finish(run_realism(arguments->options, arguments->settings, arguments->request));
  });
}

/// What experiments on several modes are told.
struct ContestArguments {
  ExperimentRequest request;
  ContestOptions options;
  RunSettings settings;
  bool simulate = false;
};

void add_contest(CLI::App& command, ContestArguments& arguments) {
  ContestOptions& options = arguments.options;
  add_common(command, arguments.request);
  add_list(command, "--modes", options.modes, "none, triggered, filtered, continuous, pairwise (none and the default)",
           "MODE,MODE,...");
  command
      .add_option("--compare", options.compare,
                  "Another system's trajectories: a file, a folder with NN.txt, or a path with {} for NN; KITTI rows")
      ->expected(1)
      ->take_all()
      ->option_text("NAME[@sim3]=POSES");
  command.add_option("--seeds", options.seeds, "Run the default mode with so many seeds on the first drive")
      ->check(CLI::Range(1, 1000));
  add_drive_settings(command, options.drives, arguments.settings);
}

void add_vo_kitti(CLI::App& parent, int& exit_status) {
  const auto arguments = std::make_shared<ContestArguments>();
  ContestOptions& options = arguments->options;
  CLI::App* command = parent.add_subcommand(kVoKittiName, kVoKittiSummary);
  add_recorded_or_simulated(*command, options.drives, arguments->simulate);
  command->add_option("--distortion", options.distortion,
                      "Render with this k1, and run as if the camera had no distortion");
  add_choice(*command, options.drives, "default the real ones, else 03,06,07,10,00:1501, or all routes");
  add_contest(*command, *arguments);
  command->callback([arguments, &exit_status] {
    prepare(arguments->request);
    arguments->options.drives.use_images = !arguments->simulate;
    arguments->settings.seed = arguments->options.drives.seed;
    exit_status = finish(run_vo_kitti(arguments->options, arguments->settings, arguments->request));
  });
}

void add_campus(CLI::App& parent, int& exit_status) {
  const auto arguments = std::make_shared<ContestArguments>();
  CLI::App* command = parent.add_subcommand(kCampusName, kCampusSummary);
  add_choice(*command, arguments->options.drives, "routes, default city:1800");
  add_contest(*command, *arguments);
  command->callback([arguments, &exit_status] {
    prepare(arguments->request);
    arguments->settings.seed = arguments->options.drives.seed;
    exit_status = finish(run_campus(arguments->options, arguments->settings, arguments->request));
  });
}

void add_calibration(CLI::App& parent, int& exit_status) {
  struct Arguments {
    ExperimentRequest request;
    CalibrationTrialOptions options;
    RunSettings settings;
  };
  const auto arguments = std::make_shared<Arguments>();
  CalibrationTrialOptions& options = arguments->options;
  CLI::App* command = parent.add_subcommand(kCalibrationName, kCalibrationSummary);
  add_common(*command, arguments->request);
  add_list(*command, "--parts", options.parts, fmt::format("Of {} (all)", fmt::join(calibration_part_names(), ", ")),
           "PART,PART,...");
  command
      ->add_option("--kitti", options.kitti,
                   "Folder with KITTI odometry's poses/NN.txt and times, for drives along them beside the route `city`")
      ->option_text("PATH");
  add_list(*command, "--sequences", options.sequences, "Which of them (default 00:500,05:500,07:500)", "NAME,NAME,...");
  command->add_option("--preset", options.preset, "Camera of the parts `seeds` and `straight` (small)");
  command->add_option("--frames", options.frames, "Of the short drives (250)")->check(CLI::Range(2, 1000000));
  command->add_option("--seeds", options.seeds, "How many worlds the part `seeds` has (20)")
      ->check(CLI::Range(1, 1000));
  add_threads(*command, options.threads);
  add_assignments(*command, arguments->settings.assignments, "KEY=VALUE of the odometry's configuration");
  command->callback([arguments, &exit_status] {
    prepare(arguments->request);
    exit_status = finish(run_calibration(arguments->options, arguments->settings, arguments->request));
  });
}

/// Which ways to measure the ground.
void add_methods(CLI::App& command, std::vector<std::string>& methods, const std::string& which) {
  add_list(command, "--methods", methods, "Values of ground.method (" + which + ")", "NAME,NAME,...");
}

void add_scale_kitti(CLI::App& parent, int& exit_status) {
  struct Arguments {
    ExperimentRequest request;
    ScaleKittiOptions options;
    RunSettings settings;
    bool simulate = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  ScaleKittiOptions& options = arguments->options;
  CLI::App* command = parent.add_subcommand(kScaleKittiName, kScaleKittiSummary);
  add_common(*command, arguments->request);
  add_recorded_or_simulated(*command, options.drives, arguments->simulate);
  add_choice(*command, options.drives, "default the real ones, else 06,07,10,00:1501, or all routes");
  add_methods(*command, options.methods, "all");
  add_drive_settings(*command, options.drives, arguments->settings);
  command->callback([arguments, &exit_status] {
    prepare(arguments->request);
    arguments->options.drives.use_images = !arguments->simulate;
    arguments->settings.seed = arguments->options.drives.seed;
    exit_status = finish(run_scale_kitti(arguments->options, arguments->settings, arguments->request));
  });
}

void add_synthetic(CLI::App& parent, int& exit_status) {
  struct Arguments {
    ExperimentRequest request;
    SyntheticOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  SyntheticOptions& options = arguments->options;
  CLI::App* command = parent.add_subcommand(kSyntheticName, kSyntheticSummary);
  add_common(*command, arguments->request);
  add_methods(*command, options.methods, "triangulation, decomposition, sparse, joint");
  const auto list = [&](const char* name, std::vector<double>& values, const std::string& what) {
    return add_list(*command, name, values, what, "X,X,...");
  };
  command
      ->add_option("--source", options.source,
                   "A drive, as run takes it, whose road features are taken (the simulator's route `straight`)")
      ->option_text("PATH");
  command->add_option("--camera", options.camera, "Camera file of the source, if it isn't the one that lies there");
  command->add_option("--frames", options.frames, "Frames whose features are taken by turns (40)")
      ->check(CLI::Range(2, 1000000));
  list("--region", options.region_px,
       "x,y,x,y,... of the road region in px (the strip of road.region, straight ahead)");
  list("--speeds", options.speeds_kmh, "km/h (12.5,50)")->check(CLI::Range(0.1, 1000.0));
  command->add_option("--rate", options.rate_hz, "Frames a second (10)")->check(CLI::Range(0.1, 1000.0));
  command->add_option("--max-noise", options.max_noise_px, "px (2)")->check(CLI::Range(0.0, 100.0));
  command->add_option("--noise-step", options.noise_step_px, "px (0.25)")->check(CLI::Range(0.01, 100.0));
  command->add_option("--trials", options.trials, "At each noise level (200)")->check(CLI::Range(1, 100000));
  list("--pitch-errors", options.pitch_errors_deg, "By how many degrees triangulation's pitch is off (0,0.5,1,-0.5,-1)")
      ->check(CLI::Range(-45.0, 45.0));
  command->add_option("--preset", options.drive.preset, "Camera of the simulator's route (kitti)");
  command->add_option("--seed", options.seed, "Of scene and noise (0)")->check(CLI::NonNegativeNumber);
  add_threads(*command, options.drive.threads);
  add_assignments(*command, options.assignments,
                  "KEY=VALUE of ground.plane, motion, road: over settings that refuse nothing for its noise");
  command->callback([arguments, &exit_status] {
    prepare(arguments->request);
    exit_status = finish(run_synthetic(arguments->options, arguments->request));
  });
}

void add_contamination(CLI::App& parent, int& exit_status) {
  struct Arguments {
    ExperimentRequest request;
    ContaminationOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  ContaminationOptions& options = arguments->options;
  CLI::App* command = parent.add_subcommand(kContaminationName, kContaminationSummary);
  add_common(*command, arguments->request);
  add_methods(*command, options.methods, "all");
  add_kitti_poses(*command, options.drives.kitti);
  add_choice(*command, options.drives, "default straight:100,city:60, or 07:100");
  add_list(*command, "--shares", options.shares_percent, "How much of the region isn't road, % (0,10,20,30,40,50)",
           "X,X,...")
      ->check(CLI::Range(0.0, 100.0));
  command->add_flag("--true-motion", options.true_motion, "R and t of the truth instead of those of the matches");
  add_walk_settings(*command, options.drives, options.assignments);
  command->callback([arguments, &exit_status] {
    prepare(arguments->request);
    exit_status = finish(run_contamination(arguments->options, arguments->request));
  });
}

void add_timing(CLI::App& parent, int& exit_status) {
  struct Arguments {
    ExperimentRequest request;
    TimingOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  TimingOptions& options = arguments->options;
  CLI::App* command = parent.add_subcommand(kTimingName, kTimingSummary);
  add_common(*command, arguments->request);
  add_methods(*command, options.methods, "all");
  add_kitti_poses(*command, options.drives.kitti);
  command->add_option("--clips", options.drives.clips, "Real drives instead: NN/image_0 and NN/poses.txt")
      ->option_text("PATH");
  add_choice(*command, options.drives, "default city:100, 07:100, or all clips");
  add_walk_settings(*command, options.drives, options.assignments);
  command->callback([arguments, &exit_status] {
    prepare(arguments->request);
    exit_status = finish(run_timing(arguments->options, arguments->request));
  });
}

void add_matching(CLI::App& parent, int& exit_status) {
  struct Arguments {
    ExperimentRequest request;
    DriveOptions drives;
    RunSettings settings;
  };
  const auto arguments = std::make_shared<Arguments>();
  DriveOptions& drives = arguments->drives;
  drives.default_sequences = {"07:300", "10:300"};
  CLI::App* command = parent.add_subcommand(kMatchingName, kMatchingSummary);
  add_common(*command, arguments->request);
  add_kitti_poses(*command, drives.kitti);
  add_choice(*command, drives, "default 07:300,10:300, or all routes");
  add_preset(*command, drives);
  add_drive_settings(*command, drives, arguments->settings);
  command->callback([arguments, &exit_status] {
    prepare(arguments->request);
    exit_status = finish(run_matching(arguments->drives, arguments->settings, arguments->request));
  });
}

/// Every experiment: a function that adds its subcommand.
constexpr void (*kExperiments[])(CLI::App&, int&) = {add_drives,      add_realism,     add_vo_kitti,  add_campus,
                                                     add_calibration, add_scale_kitti, add_synthetic, add_contamination,
                                                     add_timing,      add_matching};

std::string list_of(const CLI::App& command) {
  std::string text;
  for (const CLI::App* experiment : command.get_subcommands([](const CLI::App*) { return true; })) {
    text += fmt::format("{}{:<13} {}", text.empty() ? "" : "\n", experiment->get_name(), experiment->get_description());
  }
  return text;
}

}  // namespace

void add_experiment(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("experiment", "Tables and figures of how well it works; --list names them");
  const auto list = std::make_shared<bool>(false);
  command->add_flag("--list", *list, "Names of all experiments, a line each");
  command->require_subcommand(0, 1);
  for (const auto add : kExperiments) add(*command, exit_status);
  // For a message that names those there are; the experiments themselves, which inherit it, allow none.
  command->allow_extras();
  command->callback([command, list, &exit_status] {
    if (!command->get_subcommands().empty()) return;
    if (*list && command->remaining().empty()) {
      fmt::print("{}\n", list_of(*command));
      return;
    }
    const std::string problem = command->remaining().empty()
                                    ? std::string("the name of an experiment is missing")
                                    : fmt::format("'{}' is no experiment", command->remaining().front());
    exit_status = report_failure({ErrorCode::kBadInput, fmt::format("{}, known:\n{}", problem, list_of(*command))});
  });
}

}  // namespace groundscale
