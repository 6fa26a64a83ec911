#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "groundscale/calibration/drive_pass.hpp"
#include "groundscale/calibration/held_out.hpp"
#include "groundscale/camera/parameters.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/mapping/batch_adjustment.hpp"
#include "groundscale/mapping/drive_recorder.hpp"
#include "groundscale/odometry/options.hpp"
#include "groundscale/odometry/scale_slope.hpp"

namespace groundscale {

struct CalibrateOptions {
  int max_rounds = 3;             ///< Of odometry and batch adjustment, until the camera stays as it is.
  double settled_px = 0.5;        ///< That is: no parameter moves pixels far out by more than this.
  double min_turn_deg = 30.0;     ///< Of turning over all drives; with less nothing is observable.
  double max_change_px = 40.0;    ///< Parameters that move pixels far out by more are at their bound.
  double radial_model_px = 3.5;   ///< Sd that the tracker's own errors add to the adjustment's radial coefficient,
  double row_model_px = 0.3;      ///< to its row,
  double column_model_px = 10.0;  ///< to its column,
  double focal_model = 0.015;     ///< and to its focal length, as a share of it.
  /// Sd of radial coefficient and row, over the root of the turning in degrees: 10 degrees leave 3 px.
  double turn_px = 10.0;
  double slope_model = 0.01;      ///< Sd of the slope per 100 m that roads add,
  double slip_px = 6.0;           ///< and, times the focal length, that tracks add which creep along.
  double sensitivity = -0.023;    ///< Slope per 100 m by a pixel of radial coefficient far out, where one pass says
  double sensitivity_sd = 0.012;  ///< nothing about it; and how much that differs from drive to drive.
  double max_slope = 0.03;        ///< Per 100 m, above which a calibration is not taken over.
  double max_disagreement = 4.0;  ///< In sd, between halves and between the two ways.
  bool free_focal = false;        ///< Nothing is known of the focal length.
  DriveRecorderOptions views;
  BatchOptions batch;
};

/// A parameter, before and after.
struct CalibratedParameter {
  CameraParameter parameter = CameraParameter::kRadial;
  double before = 0.0;
  double after = 0.0;
  double sd = 0.0;     ///< 0 where it stayed and nothing was known of it.
  std::string reason;  ///< Why it stayed as it was; empty where it changed.
};

/// What one way says of a parameter.
struct ParameterEstimate {
  double value = 0.0;
  double sd = 0.0;
};

struct Calibration {
  CameraSetup setup;  ///< To be used: as it was where `adopted` is false.
  bool adopted = false;
  std::string verdict;  ///< In words.
  std::vector<CalibratedParameter> parameters;
  ParameterEstimate radial_by_tracks;                ///< Batch adjustment; sd 0 where there was none.
  std::optional<ParameterEstimate> radial_by_slope;  ///< What nulls the slope.
  std::optional<ScaleSlope> slope_before, slope_after;
  /// The same of each drive.
  std::vector<std::optional<ScaleSlope>> slopes_before, slopes_after;
  std::optional<double> length_change;  ///< Share by which lengths change at the height given.
  HeldOut held_out;                     ///< A third of the tracks, which took no part.
  double turned_deg = 0.0;              ///< All drives together.
  double length_m = 0.0;
  int frames = 0;
  int passes = 0;           ///< Of the odometry.
  double odometry_s = 0.0;  ///< Time of the odometry's first pass, and of everything.
  double total_s = 0.0;
};

/// Called with what is going on and, while the odometry runs, the frames it has done of all drives.
using CalibrateProgress = std::function<void(const std::string& what, int frames)>;

/// The camera's first radial coefficient and principal row from drives, without any truth.
///
/// The keyframe odometry runs without scale correction, a batch adjustment over the whole drive frees both numbers
/// (adjust_batch), and both are repeated with what came out until it stays. Then the slope of the odometry's scale
/// against the ground's (scale_slope) says what is left: the radial coefficient that nulls it follows from the slopes
/// of the passes (secant, which one pass alone takes from options.sensitivity), and is combined with the adjustment's
/// by their variances; where the two differ by more than these allow, both grow until they do (Birge 1932). Last the
/// row is adjusted with that coefficient, and a pass with the new camera checks the slope; a third of the tracks, which
/// took no part, the error.
///
/// Focal length and column are freed where setup.parameter_sds has them (options.free_focal: the focal length
/// anyway): the adjustment's value is combined with the one given before the others are adjusted with it. Radial
/// coefficient and row are combined with theirs at the end.
///
/// Each parameter's sd is made of the sandwich over blocks of frames, the disagreement of halves of the tracks and of
/// halves of the drive, and the tracker's own part (..._model_px). A parameter whose halves disagree, that the two ways
/// contradict each other on, or at its bound, stays as it was.
/// @param setup  The camera to begin with; height_m must be set, but says nothing about the result.
/// @return kBadInput as make_odometry; kTooFewMatches: tracks too few for an adjustment. That a drive tells nothing is
///         no error: the verdict says it.
/// Deterministic.
Result<Calibration> calibrate(const std::vector<CalibrationDrive>& drives, const CameraSetup& setup,
                              const OdometryOptions& odometry, const CalibrateOptions& options,
                              const CalibrateProgress& progress = {});

}  // namespace groundscale
