#pragma once

#include <string>

#include <fmt/format.h>

#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"

namespace groundscale::internal {

/// For tests: the files of a run straight ahead, as `run` would have written them.
struct WrittenRun {
  int frames = 40;
  double step_m = 1.0;
  double raw_off = 0.0;          ///< Of each measurement, as a share of the step.
  int refused_from = 1 << 30;    ///< Frames from here on have no accepted measurement.
  std::string source = "drive";  ///< As config.yaml has it.
  int first_frame = 0;
  int lost = 0;
  std::string truth = "null";   ///< As JSON.
  std::string warnings = "[]";  ///< As JSON.
  std::string corrections = "[]";
  std::string config = "";  ///< Further text of config.yaml.

  std::string rows(double length_m) const {
    std::string text;
    for (int k = 0; k < frames; ++k) {
      text += kitti_row({Eigen::Matrix3d::Identity(), {0.0, 0.0, length_m * k}}) + "\n";
    }
    return text;
  }

  void write(const TempFolder& folder, const std::string& name) const {
    folder.file(name + "/trajectory.kitti", rows(step_m));
    folder.file(name + "/online.kitti", rows(step_m));
    std::string tum;
    for (int k = 0; k < frames; ++k) {
      tum += tum_row(0.1 * k, {Eigen::Matrix3d::Identity(), {0.0, 0.0, step_m * k}}) + "\n";
    }
    folder.file(name + "/online.tum", tum);
    std::string csv =
        "frame,time_s,state,step_m,step_sd_m,online_step_m,raw_step_m,raw_step_sd_m,pitch_deg,roll_deg,matches,"
        "road_matches,road_inliers,reason,online_step_sd_m,map_scale,drift_ratio\n";
    int accepted = 0;
    for (int k = 0; k < frames; ++k) {
      if (k == 0) {
        csv += fmt::format("{},0,moving,,,,,,,,0,0,0,first frame,,,\n", first_frame);
        continue;
      }
      const bool refused = k >= refused_from;
      accepted += refused ? 0 : 1;
      csv += fmt::format("{},{},moving,{},{},{},{},{},0.5,-0.1,200,60,50,{},{},2.5,1.01\n", first_frame + k, 0.1 * k,
                         step_m, 0.01 * step_m, step_m, step_m * (1.0 + raw_off), 0.05 * step_m,
                         refused ? fmt::format("\"speed {:.1f} m/s, too low <b>\"", 0.1 * k) : "", 0.015 * step_m);
    }
    folder.file(name + "/frames.csv", csv);
    folder.file(name + "/config.yaml", "run:\n  source: \"" + source + "\"\n" + config);
    folder.file(name + "/summary.json", summary(accepted));
  }

  std::string summary(int accepted) const {
    return fmt::format(
        R"({{"version": "0.1.0", "source": "drive", "truth": {}, "first_frame": {}, "frames": {}, "seed": 3,
"camera": "camera.yaml", "camera_height_m": 1.65, "camera_height_from": "camera.yaml", "times_from_source": true,
"mounting": {{"pitch_deg": 0.5, "roll_deg": -0.1, "yaw_deg": 2}}, "length_m": {},
"states": {{"moving": {}, "still": 0, "rotating": 0, "bridged": 0, "lost": {}}}, "accepted_measurements": {},
"matching": {{"track_length_frames": 7.5, "matches": 200, "inlier_ratio": 0.9, "rms_px": 0.3, "road_matches": 60,
"road_inlier_ratio": 0.8, "road_rms_px": 0.4, "pitch_sd_deg": 0.2}}, "first_scaled_frame": {},
"scale_corrections": {}, "camera_changes": [{{"frame": 9, "k1": {{"value": 0.01, "sd": 0.002}}}}],
"scale_slope": {{"percent_per_100m": 0.5, "sd_percent_per_100m": 0.4, "length_m": 39, "measurements": 38, "verdict": "x"}},
"warnings": {}, "time": {{"wall_s": 1.5, "median_ms_a_frame": 20.5, "p95_ms_a_frame": 33,
"mean_ms_a_frame": {{"waiting for images": 1.25, "tracking": 12, "a plane": 3.5}}}}}}
)",
        truth, first_frame, frames, step_m * (frames - 1), frames, lost, accepted,
        accepted > 0 ? fmt::to_string(first_frame + 1) : "null", corrections, warnings);
  }
};

}  // namespace groundscale::internal
