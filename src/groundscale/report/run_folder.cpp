#include "groundscale/report/run_folder.hpp"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "groundscale/evaluation/kitti_errors.hpp"
#include "groundscale/io/config.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "groundscale/odometry/run_source.hpp"
#include "groundscale/odometry/summary_file.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::bad_input;

bool exists(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

Result<void> check_folder(const std::string& folder) {
  std::error_code ignored;
  const fs::path path = folder;
  if (!fs::exists(path, ignored)) return bad_input(folder + ": no such folder");
  if (!fs::is_directory(path, ignored)) return bad_input(folder + ": is no folder; that of a run is needed");
  if (exists((path / "summary.json").string()) && exists((path / "frames.csv").string())) return {};
  const bool begun = exists((path / "online.kitti").string());
  return bad_input(begun ? folder + ": the run in it didn't end (there is no summary.json)"
                         : folder + ": isn't the folder of a run (there is no summary.json)");
}

std::vector<RunFolder::Setting> settings_of(RunConfig& config) {
  RunConfig usual;
  const auto rows = field_rows([&config](FieldVisitor& visitor) { visit_fields(config, visitor); });
  const auto usual_rows = field_rows([&usual](FieldVisitor& visitor) { visit_fields(usual, visitor); });
  std::vector<RunFolder::Setting> settings;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    settings.push_back({rows[k].name, rows[k].value, usual_rows[k].value, rows[k].unit});
  }
  return settings;
}

/// Configuration and drive. One that can't be applied is of another version and is shown as it is.
void read_config(RunFolder& run) {
  const std::string path = (fs::path(run.folder) / "config.yaml").string();
  std::string source = run.summary.source;
  int image = -1;
  if (const auto text = read_text(path)) {
    run.config_text = *text;
    RunConfig config;
    if (apply_yaml(*text, path, [&config](FieldVisitor& visitor) { visit_fields(config, visitor); })) {
      run.settings = settings_of(config);
      source = config.run.source;
      image = config.run.image;
    }
  }
  run.drive = source;
  if (image >= 0) run.drive += fmt::format(", image_{}", image);
  if (run.summary.first_frame > 0) run.drive += fmt::format(", from frame {} on", run.summary.first_frame);
}

}  // namespace

Result<ComparedRun> compare_run(const PairingRequest& request) {
  auto paired = pair_drive(request);
  if (!paired) return paired.error();
  auto evaluation = evaluate(*paired, kitti_lengths_m());
  if (!evaluation) return evaluation.error();
  auto steps = compare_steps(paired->estimate, paired->truth);
  if (!steps) return steps.error();
  std::vector<Step> online_steps;
  if (paired->online) {
    auto online = compare_steps(*paired->online, paired->truth);
    if (!online) return online.error();
    online_steps = std::move(*online);
  }
  return ComparedRun{std::move(*paired), std::move(*evaluation), std::move(*steps), std::move(online_steps)};
}

std::vector<double> RunFolder::distances_m() const {
  std::vector<double> distances;
  double driven_m = 0.0;
  for (const FrameRow& row : frames) {
    driven_m += row.step_m.value_or(row.online_step_m.value_or(0.0));
    distances.push_back(driven_m);
  }
  return distances;
}

Result<RunFolder> read_run_folder(const std::string& folder, const std::string& truth) {
  if (const auto whole = check_folder(folder); !whole) return whole.error();
  RunFolder run;
  run.folder = folder;
  const fs::path path = folder;
  auto summary = read_run_summary((path / "summary.json").string());
  if (!summary) return summary.error();
  run.summary = std::move(*summary);
  auto frames = read_frame_table((path / "frames.csv").string());
  if (!frames) return frames.error();
  run.frames = std::move(*frames);
  auto trajectory = read_trajectory((path / "trajectory.kitti").string());
  if (!trajectory) return trajectory.error();
  run.trajectory = std::move(*trajectory);
  if (run.frames.size() != run.trajectory.world_from_cam.size()) {
    return bad_input(fmt::format("{}: frames.csv has {} rows, trajectory.kitti has {}: they are not of one run", folder,
                                 run.frames.size(), run.trajectory.size()));
  }
  read_config(run);
  auto samples = read_samples((path / "samples").string());
  if (!samples) return samples.error();
  run.samples = std::move(*samples);
  run.truth = truth.empty() ? run.summary.truth : truth;
  if (run.truth.empty()) return run;
  auto compared = compare_run({.estimate = folder,
                               .truth = run.truth,
                               .advice = "a row for every frame of the drive is needed, the first for frame 0"});
  if (compared) {
    run.compared = std::move(*compared);
  } else if (truth.empty()) {
    run.truth_problem = compared.error().message;
  } else {
    return bad_input("--truth: " + compared.error().message);
  }
  return run;
}

}  // namespace groundscale
