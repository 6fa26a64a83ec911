#include "groundscale/odometry/summary_file.hpp"

#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {
namespace {

// Stages of the time stand in the order of the work.
using Json = nlohmann::ordered_json;

constexpr double kDegree = std::numbers::pi / 180.0;

/// The value of a key where it is there and not null. Throws for another type.
template <class Value>
void take(const Json& json, const char* key, Value& value) {
  const auto found = json.find(key);
  if (found != json.end() && !found->is_null()) value = found->get<Value>();
}

template <class Value>
void take(const Json& json, const char* key, std::optional<Value>& value) {
  const auto found = json.find(key);
  if (found != json.end() && !found->is_null()) value = found->get<Value>();
}

/// A section; empty where it isn't there.
Json section_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_object() ? *found : Json::object();
}

Json list_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_array() ? *found : Json::array();
}

void take_angle(const Json& json, const char* key, double& angle_rad) {
  double angle_deg = angle_rad / kDegree;
  take(json, key, angle_deg);
  angle_rad = angle_deg * kDegree;
}

void take_states(const Json& json, RunSummary& summary) {
  const Json states = section_of(json, "states");
  take(states, "moving", summary.moving);
  take(states, "still", summary.still);
  take(states, "rotating", summary.rotating);
  take(states, "bridged", summary.bridged);
  take(states, "lost", summary.lost);
  const Json mounting = section_of(json, "mounting");
  take_angle(mounting, "pitch_deg", summary.mounting.pitch_rad);
  take_angle(mounting, "roll_deg", summary.mounting.roll_rad);
  take_angle(mounting, "yaw_deg", summary.mounting.yaw_rad);
}

void take_matching(const Json& json, MatchingFigures& matching) {
  take(json, "track_length_frames", matching.track_length);
  take(json, "matches", matching.matches);
  take(json, "inlier_ratio", matching.inlier_ratio);
  take(json, "rms_px", matching.rms_px);
  take(json, "road_matches", matching.road_matches);
  take(json, "road_inlier_ratio", matching.road_inlier_ratio);
  take(json, "road_rms_px", matching.road_rms_px);
  take(json, "pitch_sd_deg", matching.pitch_sd_deg);
}

void take_events(const Json& json, RunSummary& summary) {
  for (const Json& entry : list_of(json, "scale_corrections")) {
    ScaleEvent event;
    take(entry, "frame", event.frame);
    take(entry, "lambda", event.lambda);
    take(entry, "drift_before", event.drift_before);
    take(entry, "drift_after", event.drift_after);
    summary.corrections.push_back(event);
  }
  for (const Json& entry : list_of(json, "camera_changes")) {
    CameraEvent event;
    take(entry, "frame", event.frame);
    for (const auto& [name, value] : entry.items()) {
      if (!value.is_object()) continue;
      take(value, "value", event.values[name].value);
      take(value, "sd", event.values[name].sd);
    }
    summary.camera_changes.push_back(std::move(event));
  }
}

void take_slope(const Json& json, RunSummary& summary) {
  const Json entry = section_of(json, "scale_slope");
  if (entry.empty()) return;
  ScaleSlope slope;
  take(entry, "percent_per_100m", slope.per_100m);
  take(entry, "sd_percent_per_100m", slope.sd_per_100m);
  slope.per_100m /= 100.0;
  slope.sd_per_100m /= 100.0;
  take(entry, "length_m", slope.length_m);
  take(entry, "measurements", slope.measurements);
  summary.slope = slope;
}

void take_time(const Json& json, RunSummary& summary) {
  const Json time = section_of(json, "time");
  take(time, "wall_s", summary.wall_s);
  take(time, "median_ms_a_frame", summary.median_ms);
  take(time, "p95_ms_a_frame", summary.p95_ms);
  const Json stages = section_of(time, "mean_ms_a_frame");  // must outlive its items
  for (const auto& [stage, ms] : stages.items()) {
    summary.stage_ms.emplace_back(stage, ms.get<double>());
  }
  const Json network = section_of(time, "road_network");
  take(network, "runs", summary.network_runs);
  take(network, "mean_ms_a_run", summary.network_ms);
}

RunSummary summary_of(const Json& json) {
  RunSummary summary;
  summary.source = json.at("source").get<std::string>();
  summary.frames = json.at("frames").get<int>();
  take(json, "version", summary.version);
  take(json, "truth", summary.truth);
  take(json, "first_frame", summary.first_frame);
  take(json, "seed", summary.seed);
  take(json, "camera", summary.camera_from);
  take(json, "camera_height_m", summary.camera_height_m);
  take(json, "camera_height_from", summary.camera_height_from);
  take(json, "times_from_source", summary.has_times);
  take(json, "length_m", summary.length_m);
  take(json, "accepted_measurements", summary.accepted);
  take(json, "first_scaled_frame", summary.first_scaled_frame);
  take(json, "warnings", summary.warnings);
  take_states(json, summary);
  take_matching(section_of(json, "matching"), summary.matching);
  take_events(json, summary);
  take_slope(json, summary);
  if (const Json log = section_of(json, "speed_log"); !log.empty()) {
    RunSummary::SpeedLogFigures figures;
    take(log, "file", figures.file);
    take(log, "frames_scaled", figures.scaled);
    take(log, "ratio_to_ground", figures.ratio);
    summary.speed_log = figures;
  }
  take_time(json, summary);
  return summary;
}

}  // namespace

Result<RunSummary> read_run_summary(const std::string& path) {
  const auto text = read_text(path);
  if (!text) return text.error();
  const Json json = Json::parse(*text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return internal::bad_input(path + ": isn't JSON with the figures of a run");
  try {
    return summary_of(json);
  } catch (const Json::exception& error) {
    return internal::bad_input(fmt::format("{}: isn't the summary of a run: {}", path, error.what()));
  }
}

}  // namespace groundscale
