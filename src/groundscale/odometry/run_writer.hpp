#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "groundscale/camera/mounting.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/odometry/odometry.hpp"
#include "groundscale/odometry/scale_slope.hpp"

namespace groundscale {

/// How well points were followed and matched, over the moving frames of a run.
struct MatchingFigures {
  double track_length = 0.0;  ///< Mean number of frames that a point is seen in.
  double matches = 0.0;       ///< Medians over frames:
  double inlier_ratio = 0.0;
  double rms_px = 0.0;  ///< Epipolar error of inliers.
  double road_matches = 0.0;
  double road_inlier_ratio = 0.0;
  double road_rms_px = 0.0;   ///< Transfer error of inliers.
  double pitch_sd_deg = 0.0;  ///< Of the road's plane over accepted measurements.
};

/// What a run was made of and what came of it, for summary.json and the table at the end.
struct RunSummary {
  std::string version;  ///< Of the program that wrote it.
  std::string source;
  std::string truth;  ///< What the run was compared with; empty where it wasn't.
  int first_frame = 0;
  int frames = 0;
  int seed = 0;
  double camera_height_m = 0.0;
  std::string camera_height_from;
  std::string camera_from;
  bool has_times = true;
  Mounting mounting;
  std::vector<std::string> warnings;

  int moving = 0, still = 0, rotating = 0, bridged = 0, lost = 0;
  int accepted = 0;  ///< Frames with an accepted measurement.
  MatchingFigures matching;
  double length_m = 0.0;
  std::optional<int> first_scaled_frame;
  std::vector<ScaleEvent> corrections;
  std::vector<CameraEvent> camera_changes;
  std::optional<ScaleSlope> slope;  ///< Of the map's scale against the ground's; empty where it says nothing.
  /// With a speed log.
  struct SpeedLogFigures {
    std::string file;
    int scaled = 0;               ///< Frames whose scale it gave in place of the ground.
    std::optional<double> ratio;  ///< Its speeds over those by the ground, where both are there.
  };
  std::optional<SpeedLogFigures> speed_log;

  double wall_s = 0.0;
  std::vector<std::pair<std::string, double>> stage_ms;  ///< Mean a frame, in the order of the work.
  double median_ms = 0.0, p95_ms = 0.0;                  ///< Of a frame, decoding included.
  int network_runs = 0;                                  ///< Of the road network,
  double network_ms = 0.0;                               ///< and the mean of one.
};

/// What the drift of the map's scale says of the calibration, in words: with the one given it should be within 3 % per
/// 100 m, and what is beyond that by less than three standard deviations isn't certain.
std::string calibration_verdict(const ScaleSlope& slope);

/// Counts states, measurements and length, and warns of what is wrong with a speed log.
void add_figures(const DriveOutcome& outcome, RunSummary& summary);

/// The files of a run's folder (docs/formats.md). Online rows are written as the drive goes, the others at its end,
/// beside and renamed.
class RunWriter {
 public:
  /// Makes the folder and removes what an earlier run left there, report and sample pictures included. @return
  /// kBadInput where it holds something and `force` is not set, or can't be written.
  static Result<RunWriter> create(const std::string& folder, bool force);

  /// Online rows of all frames that have their scale by now.
  Result<void> write_online(const DriveOutcome& outcome);
  /// Everything else. A drive whose scale never became known has rows in which the camera stays where it is.
  Result<void> finish(const DriveOutcome& outcome, const RunSummary& summary, const std::string& config_yaml);

 private:
  RunWriter(std::string folder, LineWriter kitti, LineWriter tum);
  Result<void> write_rows(const DriveOutcome& outcome, bool scaled);

  std::string folder_;
  LineWriter online_kitti_, online_tum_;
  std::size_t written_ = 0;
};

}  // namespace groundscale
