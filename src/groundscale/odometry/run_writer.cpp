#include "groundscale/odometry/run_writer.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <numeric>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "groundscale/odometry/speed_check.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::string_view kFiles[] = {"trajectory.kitti", "trajectory.tum", "online.kitti", "online.tum",
                                       "frames.csv",       "summary.json",   "config.yaml",  "report.html"};

/// Pictures of an earlier run, which lie in a folder of their own; what else is there stays.
void remove_samples(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> old;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const std::string digits = name.substr(0, name.find('.'));
    const bool numbered = digits.size() >= 6 && digits.find_first_not_of("0123456789") == std::string::npos;
    if (name == "samples.csv" || (numbered && name == digits + ".jpg")) old.push_back(entry->path());
  }
  for (const fs::path& file : old) fs::remove(file, error);
  fs::remove(folder, error);  // which does nothing where something is left in it
}

std::string frames_csv(const std::vector<FrameResult>& results) {
  std::string csv =
      "frame,time_s,state,step_m,step_sd_m,online_step_m,raw_step_m,raw_step_sd_m,pitch_deg,roll_deg,matches,"
      "road_matches,road_inliers,reason,online_step_sd_m,map_scale,drift_ratio\n";
  const auto number = [](bool known, double value) { return known ? fmt::format("{}", value) : std::string(); };
  bool first = true;
  for (const FrameResult& r : results) {
    const bool step = r.scaled && !first;
    const bool raw = step && r.raw_over_online.has_value();
    const double raw_step = raw ? *r.raw_over_online * r.online_step_m : 0.0;
    csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", r.frame, r.time_s, name_of(r.state),
                       number(step, r.step_m), number(step && r.step_sd > 0.0, r.step_sd * r.step_m),
                       number(step, r.online_step_m), number(raw, raw_step), number(raw, r.raw_sd * raw_step),
                       number(r.pitch_rad.has_value(), r.pitch_rad.value_or(0.0) / kDegree),
                       number(r.roll_rad.has_value(), r.roll_rad.value_or(0.0) / kDegree), r.matches, r.road_matches,
                       r.road_inliers, internal::csv_text(r.reason),
                       number(step && r.online_step_sd > 0.0, r.online_step_sd * r.online_step_m),
                       number(r.map_scale.has_value(), r.map_scale.value_or(0.0)),
                       number(r.drift_ratio.has_value(), r.drift_ratio.value_or(0.0)));
    first = false;
  }
  return csv;
}

std::string summary_json(const RunSummary& s) {
  nlohmann::ordered_json json;
  json["version"] = GROUNDSCALE_VERSION;
  json["source"] = s.source;
  json["truth"] = s.truth.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(s.truth);
  json["first_frame"] = s.first_frame;
  json["frames"] = s.frames;
  json["seed"] = s.seed;
  json["camera"] = s.camera_from;
  json["camera_height_m"] = s.camera_height_m;
  json["camera_height_from"] = s.camera_height_from;
  json["times_from_source"] = s.has_times;
  json["mounting"] = {{"pitch_deg", s.mounting.pitch_rad / kDegree},
                      {"roll_deg", s.mounting.roll_rad / kDegree},
                      {"yaw_deg", s.mounting.yaw_rad / kDegree}};
  json["length_m"] = s.length_m;
  json["states"] = {
      {"moving", s.moving}, {"still", s.still}, {"rotating", s.rotating}, {"bridged", s.bridged}, {"lost", s.lost}};
  json["accepted_measurements"] = s.accepted;
  const MatchingFigures& m = s.matching;
  json["matching"] = {{"track_length_frames", m.track_length}, {"matches", m.matches},
                      {"inlier_ratio", m.inlier_ratio},        {"rms_px", m.rms_px},
                      {"road_matches", m.road_matches},        {"road_inlier_ratio", m.road_inlier_ratio},
                      {"road_rms_px", m.road_rms_px},          {"pitch_sd_deg", m.pitch_sd_deg}};
  json["first_scaled_frame"] = nullptr;
  if (s.first_scaled_frame) json["first_scaled_frame"] = *s.first_scaled_frame;
  json["scale_corrections"] = nlohmann::ordered_json::array();
  for (const ScaleEvent& event : s.corrections) {
    json["scale_corrections"].push_back(
        {{"frame", event.frame},
         {"lambda", event.lambda},
         {"drift_before", event.drift_before},
         {"drift_after", event.drift_after ? nlohmann::json(*event.drift_after) : nlohmann::json()}});
  }
  json["camera_changes"] = nlohmann::ordered_json::array();
  for (const CameraEvent& event : s.camera_changes) {
    nlohmann::ordered_json change = {{"frame", event.frame}};
    for (const auto& [name, value] : event.values) change[name] = {{"value", value.value}, {"sd", value.sd}};
    json["camera_changes"].push_back(change);
  }
  json["scale_slope"] = nullptr;
  if (s.slope) {
    json["scale_slope"] = {{"percent_per_100m", 100.0 * s.slope->per_100m},
                           {"sd_percent_per_100m", 100.0 * s.slope->sd_per_100m},
                           {"length_m", s.slope->length_m},
                           {"measurements", s.slope->measurements},
                           {"verdict", calibration_verdict(*s.slope)}};
  }
  if (s.speed_log) {
    const std::optional<double>& ratio = s.speed_log->ratio;
    json["speed_log"] = {{"file", s.speed_log->file},
                         {"frames_scaled", s.speed_log->scaled},
                         {"ratio_to_ground", ratio ? nlohmann::json(*ratio) : nlohmann::json()}};
  }
  json["warnings"] = s.warnings;
  json["time"] = {{"wall_s", s.wall_s}, {"median_ms_a_frame", s.median_ms}, {"p95_ms_a_frame", s.p95_ms}};
  for (const auto& [stage, ms] : s.stage_ms) json["time"]["mean_ms_a_frame"][stage] = ms;
  if (s.network_runs > 0) json["time"]["road_network"] = {{"runs", s.network_runs}, {"mean_ms_a_run", s.network_ms}};
  // Names of files may hold bytes that are no UTF-8.
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

double sd_of(const std::vector<double>& values) {
  if (values.size() < 2) return 0.0;
  const auto count = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / (count - 1.0));
}

MatchingFigures matching_figures(const std::vector<FrameResult>& results) {
  std::vector<double> matches, inlier_ratio, rms_px, road_matches, road_inlier_ratio, road_rms_px, pitches;
  double seen = 0.0;
  double begun = 0.0;
  for (const FrameResult& r : results) {
    seen += r.tracks;
    begun += r.tracks - r.tracks_kept;
    if (r.state != FrameState::kMoving || r.matches == 0) continue;
    matches.push_back(r.matches);
    inlier_ratio.push_back(static_cast<double>(r.inliers) / r.matches);
    rms_px.push_back(r.rms_px);
    if (r.road_matches == 0 || r.road_inliers == 0) continue;
    road_matches.push_back(r.road_matches);
    road_inlier_ratio.push_back(static_cast<double>(r.road_inliers) / r.road_matches);
    if (r.road_rms_px > 0.0) road_rms_px.push_back(r.road_rms_px);
    if (r.accepted()) pitches.push_back(*r.pitch_rad / kDegree);
  }
  MatchingFigures figures;
  figures.track_length = begun > 0.0 ? seen / begun : 0.0;
  if (matches.empty()) return figures;
  figures.matches = median(matches);
  figures.inlier_ratio = median(inlier_ratio);
  figures.rms_px = median(rms_px);
  if (road_matches.empty()) return figures;
  figures.road_matches = median(road_matches);
  figures.road_inlier_ratio = median(road_inlier_ratio);
  if (!road_rms_px.empty()) figures.road_rms_px = median(road_rms_px);
  figures.pitch_sd_deg = sd_of(pitches);
  return figures;
}

void add_speed_figures(const SpeedReference& speed, const std::vector<FrameResult>& results, RunSummary& summary) {
  const auto scaled =
      std::count_if(results.begin(), results.end(), [](const FrameResult& r) { return r.by_speed_log; });
  summary.speed_log = {speed.options().file, static_cast<int>(scaled), speed.ratio()};
  for (std::string& warning : speed_warnings(speed, results)) summary.warnings.push_back(std::move(warning));
}

}  // namespace

std::string calibration_verdict(const ScaleSlope& slope) {
  constexpr double kMostSlope = 0.03;  // per 100 m
  constexpr double kCertain = 3.0;     // sd
  const double size = std::abs(slope.per_100m);
  if (size <= kMostSlope && slope.sd_per_100m <= kMostSlope) return "no sign of a wrong calibration";
  if (size <= kMostSlope) return "too uncertain to say anything about the calibration";
  if (size < kCertain * slope.sd_per_100m) {
    return "perhaps a calibration that isn't right, not certain: groundscale calibrate looks closer";
  }
  return "the calibration looks wrong: groundscale calibrate finds a better one";
}

void add_figures(const DriveOutcome& outcome, RunSummary& summary) {
  summary.frames = static_cast<int>(outcome.results().size());
  summary.mounting = outcome.mounting();
  for (const FrameResult& result : outcome.results()) {
    switch (result.state) {
      case FrameState::kMoving:
        ++summary.moving;
        break;
      case FrameState::kStill:
        ++summary.still;
        break;
      case FrameState::kRotating:
        ++summary.rotating;
        break;
      case FrameState::kBridged:
        ++summary.bridged;
        break;
      case FrameState::kLost:
        ++summary.lost;
        break;
    }
    if (result.accepted()) ++summary.accepted;
    if (!summary.first_scaled_frame && (result.accepted() || result.by_speed_log)) {
      summary.first_scaled_frame = result.frame;
    }
    if (outcome.scaled()) summary.length_m += result.step_m;
  }
  summary.corrections = outcome.corrections();
  summary.camera_changes = outcome.camera_changes();
  if (auto slope = scale_slope(outcome.results(), summary.corrections)) summary.slope = std::move(*slope);
  summary.matching = matching_figures(outcome.results());
  if (const SpeedReference* speed = outcome.speed_reference()) add_speed_figures(*speed, outcome.results(), summary);
  if (outcome.road_detector() == nullptr) return;
  summary.network_runs = outcome.road_detector()->runs();
  summary.network_ms = 1e3 * outcome.road_detector()->network_s() / std::max(1, summary.network_runs);
}

Result<RunWriter> RunWriter::create(const std::string& folder, bool force) {
  if (const auto free = check_output_folder("--output", folder, force); !free) return free.error();
  if (const auto made = make_output_folder("--output", folder); !made) return made.error();
  std::error_code error;
  for (const std::string_view file : kFiles) fs::remove(fs::path(folder) / file, error);
  remove_samples(fs::path(folder) / "samples");
  auto kitti = LineWriter::create((fs::path(folder) / "online.kitti").string());
  if (!kitti) return Error{ErrorCode::kBadInput, kitti.error().message};
  auto tum = LineWriter::create((fs::path(folder) / "online.tum").string());
  if (!tum) return Error{ErrorCode::kBadInput, tum.error().message};
  return RunWriter(folder, std::move(*kitti), std::move(*tum));
}

RunWriter::RunWriter(std::string folder, LineWriter kitti, LineWriter tum)
    : folder_(std::move(folder)), online_kitti_(std::move(kitti)), online_tum_(std::move(tum)) {}

Result<void> RunWriter::write_online(const DriveOutcome& outcome) {
  return outcome.scaled() ? write_rows(outcome, true) : Result<void>();
}

Result<void> RunWriter::write_rows(const DriveOutcome& outcome, bool scaled) {
  for (; written_ < outcome.results().size(); ++written_) {
    RigidTransform pose = outcome.online_poses()[written_];
    if (!scaled) pose.translation.setZero();
    if (const auto done = online_kitti_.write(kitti_row(pose)); !done) return done;
    if (const auto done = online_tum_.write(tum_row(outcome.results()[written_].time_s, pose)); !done) return done;
  }
  return {};
}

Result<void> RunWriter::finish(const DriveOutcome& outcome, const RunSummary& summary, const std::string& config_yaml) {
  if (const auto done = write_rows(outcome, outcome.scaled()); !done) return done;
  Trajectory trajectory;
  trajectory.world_from_cam = outcome.final_poses();
  for (std::size_t k = 0; k < trajectory.world_from_cam.size(); ++k) {
    if (!outcome.scaled()) trajectory.world_from_cam[k].translation.setZero();
    trajectory.times_s.push_back(outcome.results()[k].time_s);
  }
  const auto path = [this](std::string_view file) { return (fs::path(folder_) / file).string(); };
  if (const auto done = write_kitti(path("trajectory.kitti"), trajectory); !done) return done;
  if (const auto done = write_tum(path("trajectory.tum"), trajectory); !done) return done;
  if (const auto done = write_text(path("frames.csv"), frames_csv(outcome.results())); !done) return done;
  if (const auto done = write_text(path("config.yaml"), config_yaml); !done) return done;
  return write_text(path("summary.json"), summary_json(summary));
}

}  // namespace groundscale
