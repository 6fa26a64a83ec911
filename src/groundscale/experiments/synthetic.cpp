#include "groundscale/experiments/synthetic.hpp"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "groundscale/experiments/method_choice.hpp"
#include "groundscale/experiments/rendered_drive.hpp"
#include "groundscale/experiments/report_parts.hpp"
#include "groundscale/experiments/source_drive.hpp"
#include "groundscale/experiments/synthetic_results_internal.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/road/road_matcher.hpp"
#include "groundscale/simulation/camera_presets.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::bad_input;
using internal::SyntheticBench;
using internal::SyntheticResults;

constexpr const char* kRoute = "straight";

/// Of the chosen ones none may need pixels: there are none.
Result<std::vector<PlaneMethod>> choose_synthetic_methods(const std::vector<std::string>& names) {
  auto methods = choose_ground_methods(names, {"triangulation", "decomposition", "sparse", "joint"});
  if (!methods) return methods.error();
  std::vector<std::string_view> known;
  for (const PlaneMethod& method : plane_methods()) known.push_back(method.name);
  for (const PlaneMethod& method : *methods) {
    if (std::find(known.begin(), known.end(), method.name) != known.end()) continue;
    return bad_input(fmt::format("--methods: \"{}\" needs images, made-up matches have none; those that don't: {}",
                                 method.name, fmt::join(known, ", ")));
  }
  return methods;
}

std::string settings_in_words(const OdometryOptions& options) {
  const PlaneOptions& plane = options.ground.plane;
  return fmt::format(
      "Settings, the same for all methods: `ground.plane`: max_epipolar_px {:g}, max_error_px {:g}, huber_px {:g}, "
      "normal_prior_deg {:g}, min_inliers {}; `motion`: max_error_px {:g}, loss_px {:g}. There are no outliers, so "
      "that "
      "these refuse nothing for its noise.",
      plane.max_epipolar_px, plane.max_error_px, plane.huber_px, plane.normal_prior_deg, plane.min_inliers,
      options.motion.max_error_px, options.motion.loss_px);
}

Image region_of(const SyntheticWorld& world, const SyntheticOptions& options, const OdometryOptions& odometry) {
  RegionOptions region = odometry.road.region;
  if (!options.region_px.empty()) region.polygon_px = options.region_px;
  return region_mask({}, world.metric_road, *world.camera, region);
}

/// Camera and road, before anything is rendered.
Result<SyntheticWorld> make_world(const SyntheticOptions& options, const OdometryOptions& odometry) {
  constexpr std::size_t kMinNumbers = 6;
  if (options.region_px.size() % 2 != 0 || (!options.region_px.empty() && options.region_px.size() < kMinNumbers)) {
    return bad_input("--region: x,y of three corners at least are needed");
  }
  SyntheticWorld world;
  if (options.source.empty()) {
    const auto preset = find_camera_preset(options.drive.preset);
    if (!preset) return preset.error();
    world.camera = preset->camera;
    world.metric_road.height = preset->options.rig.height_m;
  } else {
    const auto drive = open_source_drive(options.source, options.camera, options.frames);
    if (!drive) return drive.error();
    world.camera = drive->setup.camera;
    world.metric_road.height = *drive->setup.height_m;
  }
  if (mask_area(region_of(world, options, odometry)) > 0) return world;
  return bad_input(fmt::format("--region: no pixel of the image ({} x {}) lies in it", world.camera->width(),
                               world.camera->height()));
}

/// Corners of each frame's road region, as the odometry detects them.
Result<std::vector<std::vector<Eigen::Vector2d>>> find_features(const std::string& source, const Image& region,
                                                                const SyntheticOptions& options,
                                                                const OdometryOptions& odometry) {
  const auto drive = open_source_drive(source, options.camera, options.frames);
  if (!drive) return drive.error();
  std::vector<std::vector<Eigen::Vector2d>> features;
  RoadMatcher matcher(odometry.road.tracking);
  while (auto frame = drive->sequence->next()) {
    if (frame->image.empty()) continue;
    RoadView view{std::move(frame->image), {}};
    matcher.fill(view, region);
    std::vector<Eigen::Vector2d> pixels;
    for (const TrackPoint& point : view.points) pixels.push_back(point.pixel);
    if (static_cast<int>(pixels.size()) >= odometry.ground.plane.min_inliers) features.push_back(std::move(pixels));
  }
  if (!features.empty()) return features;
  return bad_input(
      fmt::format("{}: no frame has {} features in the road region", source, odometry.ground.plane.min_inliers));
}

Result<ExperimentOutcome> report(const SyntheticResults& results, const SyntheticBench& bench,
                                 const SyntheticOptions& options, const ExperimentRequest& request) {
  const fs::path output = request.output;
  ExperimentOutcome outcome;
  outcome.report = (output / fmt::format("{}.md", kSyntheticName)).string();
  const std::string csv = internal::synthetic_table(results).csv();
  if (const auto written = write_text((output / fmt::format("{}.csv", kSyntheticName)).string(), csv); !written) {
    return written.error();
  }
  std::vector<Plot> plots = internal::synthetic_plots(results);
  const bool drawn = write_figures(request.output, plots, outcome.problems);
  const std::string findings = in_words(internal::synthetic_findings(results));
  std::string tables;
  for (std::size_t setting = 0; setting < results.settings.size(); ++setting) {
    tables += fmt::format("### {}\n\n{}\n", results.settings[setting].label(),
                          internal::synthetic_overview(results, setting));
    outcome.table +=
        fmt::format("{}\n\n{}\n", results.settings[setting].label(), internal::synthetic_overview(results, setting));
  }
  outcome.table += findings;
  std::size_t features = 0;
  for (const auto& frame : bench.features) features += frame.size();
  std::string text = fmt::format("# Experiment `{}`: {}\n\n    {}\n\n{}. ", kSyntheticName, kSyntheticSummary,
                                 request.command, program_version());
  text += fmt::format(
      "{} trials a point, seed {}. Features of {} frames of {}, {} a frame on average; camera {:g} m above a level "
      "road, "
      "{:g} frames a second.\n{}\n\n",
      options.trials, options.seed, bench.features.size(), bench.source, features / bench.features.size(),
      bench.world.metric_road.height, options.rate_hz, settings_in_words(bench.options));
  if (!outcome.problems.empty()) text += "**Not complete:**\n\n" + bullet_list(outcome.problems);
  text += fmt::format(
      "## The paper's findings\n\nJudged by medians, setting by setting; each holds where it holds at every noise "
      "level "
      "that it is about (docs/experiments.md of groundscale).\n\n{}\n## Medians of |scale / true scale - 1|\n\nA trial "
      "in which a method refuses counts as the largest error. The last row is the mean over all noise levels. With "
      "quartiles and refusals: `{}.csv`.\n\n{}",
      findings, kSyntheticName, tables);
  text += figures_section(plots, drawn);
  if (const auto written = write_report(outcome.report, text); !written) return written.error();
  return outcome;
}

/// Where the features come from: the folder that is named, or the simulator's.
Result<std::string> obtain_source(const SyntheticOptions& options, const std::vector<DriveChoice>& choice,
                                  const ExperimentRequest& request) {
  if (!options.source.empty()) return options.source;
  auto drive = obtain_drive(choice.front(), options.drive, (fs::path(request.output) / "drive").string(), request);
  if (!drive) return drive.error();
  return drive->folder;
}

}  // namespace

Result<ExperimentOutcome> run_synthetic(const SyntheticOptions& given, const ExperimentRequest& request) {
  SyntheticOptions options = given;
  auto methods = choose_synthetic_methods(options.methods);
  if (!methods) return methods.error();
  const auto odometry = assigned_options(internal::synthetic_settings(), options.assignments);
  if (!odometry) return odometry.error();
  options.drive.sequences = {fmt::format("{}:{}", kRoute, options.frames)};
  const auto choice = choose_drives(options.drive);
  if (!choice) return choice.error();
  auto world = make_world(options, *odometry);
  if (!world) return world.error();
  if (const auto free = check_experiment_folder(kSyntheticName, request); !free) return free.error();
  const auto lock = claim_experiment_folder(kSyntheticName, request);
  if (!lock) return lock.error();

  const auto source = obtain_source(options, *choice, request);
  if (!source) return source.error();
  auto features = find_features(*source, region_of(*world, options, *odometry), options, *odometry);
  if (!features) return features.error();
  const SyntheticBench bench{
      .world = std::move(*world),
      .features = std::move(*features),
      .methods = std::move(*methods),
      .options = *odometry,
      .source = options.source.empty() ? fmt::format("the simulator's route `{}`", kRoute) : options.source};
  const SyntheticResults results = internal::measure_synthetic(bench, options, request.say);
  return report(results, bench, options, request);
}

}  // namespace groundscale
