#include "groundscale/experiments/realism.hpp"

#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "groundscale/experiments/image_statistics.hpp"
#include "groundscale/experiments/recorded_drive.hpp"
#include "groundscale/experiments/report_parts.hpp"
#include "groundscale/experiments/table.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/trajectory_file.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;

/// A drive that was run, and its images.
struct Side {
  RenderedDrive drive;
  MeasuredRun run;
  ImageStatistics images;
};
struct Comparison {
  std::string name;
  Side real, simulated;
  std::string pair;  ///< Picture of both.
};

/// A figure of a side, and how it is shown.
struct Figure {
  std::string name;
  std::string title;
  int decimals = 2;
  std::optional<double> (*of)(const Side&);
};

template <int Band>
std::optional<double> noise_of(const Side& side) {
  return side.images.noise[Band];
}

const std::vector<Figure>& figures() {
  static const std::vector<Figure> all = {
      {"raw_scale_spread", "raw scale spread %", 2, [](const Side& s) { return s.run.figure("raw_scale_spread"); }},
      {"inlier_ratio", "inlier ratio of matches", 3,
       [](const Side& s) { return s.run.figure("matching_inlier_ratio"); }},
      {"rms_px", "epipolar error of inliers, median over frames of the rms, px", 3,
       [](const Side& s) { return s.run.figure("matching_rms_px"); }},
      {"matches", "matches a frame", 0, [](const Side& s) { return s.run.figure("matching_matches"); }},
      {"track_length", "frames a track is followed", 1,
       [](const Side& s) { return s.run.figure("matching_track_length_frames"); }},
      {"road_matches", "road matches a frame", 0, [](const Side& s) { return s.run.figure("matching_road_matches"); }},
      {"road_inlier_ratio", "inlier ratio of road matches", 3,
       [](const Side& s) { return s.run.figure("matching_road_inlier_ratio"); }},
      {"road_rms_px", "transfer error of road inliers, median over frames of the rms, px", 3,
       [](const Side& s) { return s.run.figure("matching_road_rms_px"); }},
      {"pitch_sd_deg", "sd of the plane's pitch, deg", 2,
       [](const Side& s) { return s.run.figure("matching_pitch_sd_deg"); }},
      {"refused_share", "share of frames refused", 3, [](const Side& s) { return std::optional(s.run.refused_share); }},
      {"raw_scale_spread_straight", "raw scale spread, straights %", 2,
       [](const Side& s) { return s.run.figure("raw_scale_spread_straight"); }},
      {"raw_scale_spread_turn", "raw scale spread, turns %", 2,
       [](const Side& s) { return s.run.figure("raw_scale_spread_turn"); }},
      {"raw_scale_bias", "raw scale bias %", 2, [](const Side& s) { return s.run.figure("raw_scale_bias"); }},
      {"raw_p95", "raw error, 95th percentile %", 2, [](const Side& s) { return s.run.figure("raw_p95"); }},
      {"scale_spread", "final scale spread %", 2, [](const Side& s) { return s.run.figure("scale_spread"); }},
      {"rotation_error", "rotation error, deg a frame", 4,
       [](const Side& s) { return s.run.figure("rotation_error"); }},
      {"mean_grey", "mean grey level", 1, [](const Side& s) { return std::optional(s.images.mean); }},
      {"sd_grey", "sd of grey levels", 1, [](const Side& s) { return std::optional(s.images.sd); }},
      {"bright_share", "share of pixels from 250", 3,
       [](const Side& s) { return std::optional(s.images.bright_share); }},
      {"dark_share", "share of pixels up to 15", 3, [](const Side& s) { return std::optional(s.images.dark_share); }},
      {"gradient", "mean gradient a pixel", 2, [](const Side& s) { return std::optional(s.images.gradient); }},
      {"noise_16", "noise in flat regions of grey 0 to 31", 2, noise_of<0>},
      {"noise_48", "grey 32 to 63", 2, noise_of<1>},
      {"noise_80", "grey 64 to 95", 2, noise_of<2>},
      {"noise_112", "grey 96 to 127", 2, noise_of<3>},
      {"noise_144", "grey 128 to 159", 2, noise_of<4>},
      {"noise_176", "grey 160 to 191", 2, noise_of<5>},
      {"noise_208", "grey 192 to 223", 2, noise_of<6>}};
  return all;
}

Result<RenderedDrive> real_drive(const RealismOptions& options, const DriveChoice& choice) {
  const fs::path folder = fs::path(options.clips) / choice.name;
  DriveChoice real = choice;
  real.name += " (real)";
  real.recorded = folder.string();
  real.poses = (folder / "poses.txt").string();
  return recorded_drive(real);
}

Result<Side> finish_side(RenderedDrive drive, int frames, const RunSettings& settings, const std::string& folder,
                         const ExperimentRequest& request) {
  auto run = measure_run(drive, settings, folder, request);
  if (!run) return run.error();
  auto images = image_statistics(drive.folder, frames);
  if (!images) return images.error();
  return Side{std::move(drive), std::move(*run), *images};
}

Result<Comparison> compare(const DriveChoice& choice, const RealismOptions& options, const RunSettings& settings,
                           const ExperimentRequest& request) {
  const fs::path folder = fs::path(request.output) / "drives" / choice.name;
  auto real = real_drive(options, choice);
  if (!real) return real.error();
  auto simulated = obtain_drive(choice, options.drives, (folder / "drive").string(), request);
  if (!simulated) return simulated.error();
  // The road's height under the camera is the one thing that the truth of a real drive doesn't tell; both sides have
  // what is documented for KITTI.
  auto real_side = finish_side(std::move(*real), choice.frames, settings, (folder / "real").string(), request);
  if (!real_side) return real_side.error();
  auto simulated_side =
      finish_side(std::move(*simulated), choice.frames, settings, (folder / "simulated").string(), request);
  if (!simulated_side) return simulated_side.error();
  Comparison comparison{choice.name, std::move(*real_side), std::move(*simulated_side), ""};
  const std::string image = fmt::format("image_0/{:06d}.png", std::min(options.pair_frame, choice.frames - 1));
  comparison.pair = (folder / "pair.png").string();
  const auto written = write_pair(comparison.real.drive.folder + "/" + image,
                                  comparison.simulated.drive.folder + "/" + image, comparison.pair);
  if (!written) return written.error();
  return comparison;
}

/// A row a figure: of each drive the real one, the simulated one, and their ratio.
Table table_of(const std::vector<Comparison>& comparisons) {
  std::vector<Column> columns = {{.name = "figure", .title = "", .text = true}};
  for (const Comparison& c : comparisons) {
    columns.push_back({.name = c.name + "_real", .title = c.name + " real", .text = true});
    columns.push_back({.name = c.name + "_simulated", .title = c.name + " simulated", .text = true});
    columns.push_back({.name = c.name + "_ratio", .title = "ratio", .text = true});
  }
  Table table(columns);
  for (const Figure& figure : figures()) {
    std::vector<Cell> cells = {figure.title};
    for (const Comparison& c : comparisons) {
      const auto real = figure.of(c.real);
      const auto simulated = figure.of(c.simulated);
      const auto text = [&figure](const std::optional<double>& value) {
        return value ? fmt::format("{:.{}f}", *value, figure.decimals) : std::string();
      };
      cells.emplace_back(text(real));
      cells.emplace_back(text(simulated));
      cells.emplace_back(real && simulated && *real != 0.0 ? fmt::format("{:.2f}", *simulated / *real) : std::string());
    }
    table.add_row(std::move(cells));
  }
  return table;
}

std::string csv_of(const std::vector<Comparison>& comparisons) {
  std::vector<Column> columns = {{.name = "drive", .title = "drive", .text = true},
                                 {.name = "side", .title = "side", .text = true}};
  for (const Figure& figure : figures()) columns.push_back({.name = figure.name, .title = figure.title});
  Table table(columns);
  for (const Comparison& c : comparisons) {
    for (const Side* side : {&c.real, &c.simulated}) {
      std::vector<Cell> cells = {c.name, std::string(side == &c.real ? "real" : "simulated")};
      for (const Figure& figure : figures()) cells.emplace_back(figure.of(*side));
      table.add_row(std::move(cells));
    }
  }
  return table.csv();
}

Result<ExperimentOutcome> report(const std::vector<Comparison>& comparisons, const ExperimentRequest& request) {
  const fs::path output = request.output;
  const Table table = table_of(comparisons);
  std::vector<std::string> names;
  for (const Column& column : table.columns()) names.push_back(column.name);
  ExperimentOutcome outcome;
  outcome.table = table.markdown(names);
  outcome.report = (output / "realism.md").string();
  std::string text = fmt::format("# Experiment `{}`: {}\n\n    {}\n\n{}. With full precision: `realism.csv`.\n\n{}\n",
                                 kRealismName, kRealismSummary, request.command, program_version(), outcome.table);
  text += "## Pictures\n\nThe real image above, the simulated one below.\n\n";
  for (const Comparison& c : comparisons) {
    text += fmt::format("![{}]({})\n", c.name, fs::relative(c.pair, output).string());
  }
  text += "\n## Steps\n\n";
  for (const Comparison& c : comparisons) {
    text += fmt::format("    {}\n", c.simulated.drive.command);
    for (const Side* side : {&c.real, &c.simulated}) {
      for (const std::string& command : side->run.commands) text += fmt::format("    {}\n", command);
    }
  }
  if (const auto written = write_text((output / "realism.csv").string(), csv_of(comparisons)); !written) {
    return written.error();
  }
  if (const auto written = write_report(outcome.report, text); !written) return written.error();
  return outcome;
}

/// Each sequence with as many frames as the real drive has.
Result<std::vector<DriveChoice>> choose(RealismOptions options) {
  if (options.drives.sequences.empty()) options.drives.sequences = {"00", "07"};
  for (std::string& sequence : options.drives.sequences) {
    const std::string poses = (fs::path(options.clips) / sequence / "poses.txt").string();
    const auto truth = read_trajectory(poses);
    if (!truth) return Error{ErrorCode::kBadInput, fmt::format("--clips: {}", truth.error().message)};
    sequence += fmt::format(":{}", truth->size());
  }
  return choose_drives(options.drives);
}

}  // namespace

Result<ExperimentOutcome> run_realism(const RealismOptions& options, const RunSettings& settings,
                                      const ExperimentRequest& request) {
  if (const auto valid = settings.validate(); !valid) return valid.error();
  const auto choices = choose(options);
  if (!choices) return choices.error();
  if (const auto free = check_experiment_folder(kRealismName, request); !free) return free.error();
  const auto lock = claim_experiment_folder(kRealismName, request);
  if (!lock) return lock.error();
  std::vector<Comparison> comparisons;
  for (const DriveChoice& choice : *choices) {
    auto comparison = compare(choice, options, settings, request);
    if (!comparison) return Error{ErrorCode::kIo, fmt::format("drive {}: {}", choice.name, comparison.error().message)};
    comparisons.push_back(std::move(*comparison));
  }
  return report(comparisons, request);
}

}  // namespace groundscale
