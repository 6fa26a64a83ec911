#pragma once

#include <map>
#include <optional>
#include <vector>

#include "groundscale/camera/parameters.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/mapping/batch_adjustment.hpp"
#include "groundscale/mapping/drive_recorder.hpp"
#include "groundscale/odometry/frame_result.hpp"
#include "groundscale/odometry/scale_slope.hpp"

namespace groundscale {

/// Whether the camera's numbers stay as given while driving.
enum class CameraRefinement { kNone, kOnline };
template <>
std::vector<std::string_view> names_of<CameraRefinement>();

struct CameraRefineOptions {
  CameraRefinement refine = CameraRefinement::kNone;
  double window_m = 50.0;         ///< Of the way, that is looked at together; a turn isn't cut in two.
  double min_turn_deg = 30.0;     ///< Of turning in it; with less it says nothing.
  double radial_prior_px = 6.0;   ///< Sd of the radial coefficient given, by what it moves pixels far out,
  double row_prior_px = 4.0;      ///< and of the row, where the camera file states none.
  double radial_model_px = 3.5;   ///< Sd that the tracker's own errors add to the adjustment's radial coefficient,
  double row_model_px = 0.7;      ///< and to its row;
  double row_turn_px = 10.0;      ///< that over the root of the window's turning in degrees comes to it.
  double slope_model = 0.02;      ///< Sd of a window's slope per 100 m that roads add.
  double sensitivity = -0.023;    ///< Slope per 100 m by a pixel of radial coefficient far out,
  double sensitivity_sd = 0.012;  ///< and how much that differs from window to window.
  double least_change_px = 0.2;   ///< Smaller changes wait.
  DriveRecorderOptions views;
  BatchOptions batch;
};

void visit_fields(CameraRefineOptions& options, FieldVisitor& visitor);

/// Finds the camera's radial coefficient and principal row while driving, from windows of the way that hold a turn.
///
/// A window's tracks are adjusted as a whole with both free (adjust_batch): a statement on both. The slope of the map's
/// scale against the ground's in the window, over the slope that a pixel of radial coefficient makes, is another on the
/// radial coefficient. Prior, tracks and slope are combined by their variances; statements of one kind share the errors
/// of their kind (..._model), which are added to their mean. Deterministic. Memory: the tracks of a window.
class CameraRefiner {
 public:
  /// A frame that the map has placed.
  struct Placed {
    int frame = 0;                  ///< In the source.
    RigidTransform cam_from_world;  ///< Camera axes are the start camera's; the world is the map's.
    double unit_m = 1.0;            ///< Metres per unit of the map, about.
    double step_m = 0.0;
    std::optional<double> measured = std::nullopt;  ///< The ground's metres per unit, where it was accepted.
    double measured_sd = 0.0;                       ///< Of its log.
  };

  CameraRefiner(const CameraSetup& setup, const CameraRefineOptions& options);

  void add(const Placed& placed, const std::vector<TrackPoint>& tracks);
  /// The map is another one, or was scaled: a window begins.
  void restart();
  /// The camera to be used from now on, where that is another one than before; a window begins.
  std::optional<CameraPtr> next();

  /// What was changed so far.
  const std::vector<CameraEvent>& events() const { return events_; }

 private:
  /// Mean of statements by their variances.
  struct Mean {
    double information = 0.0;
    double weighted = 0.0;
    void add(double value, double sd);
  };
  /// A number of the camera, in pixels far out from where it started.
  struct State {
    CameraParameter parameter = CameraParameter::kRadial;
    double start = 0.0;
    double step = 1.0;
    double prior_px = 1.0;
    double model_px = 0.0;  ///< Of the tracks.
    Mean by_tracks;
    Mean by_slope;
    double value_px = 0.0;  ///< All combined.
    double sd_px = 0.0;
  };
  State state_of(CameraParameter parameter, const CameraSetup& setup, double prior_px, double model_px) const;
  void close_window();
  void ask_tracks(double turned_deg);
  void ask_slope();
  void combine(State& state) const;
  double applied_px(const State& state) const {
    return (value_of(state.parameter, *camera_) - state.start) / state.step;
  }

  CameraRefineOptions options_;
  CameraPtr start_camera_, camera_;
  State radial_, row_;

  // The window:
  DriveRecorder recorder_;
  std::vector<RigidTransform> world_from_cam_;    ///< Camera axes are the present camera's, the world is the map's;
  std::vector<RigidTransform> world_from_cam_m_;  ///< the same in metres.
  std::vector<ScaleSlope::Sample> samples_;
  double length_m_ = 0.0;
  int frame_ = 0;
  std::vector<CameraEvent> events_;
};

}  // namespace groundscale
