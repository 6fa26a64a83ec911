#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "groundscale/calibration/batch_adjustment.hpp"
#include "groundscale/calibration/drive_recorder.hpp"
#include "groundscale/calibration/scale_slope.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/sequence.hpp"
#include "groundscale/odometry/options.hpp"

namespace groundscale {

struct CalibrateOptions {
  int max_rounds = 3;             ///< Of odometry and batch adjustment, until the camera stays as it is.
  double settled_px = 0.5;        ///< That is: no parameter moves pixels far out by more than this.
  double min_turn_deg = 30.0;     ///< Of turning over all drives; with less nothing is observable.
  double max_change_px = 40.0;    ///< Parameters that move pixels far out by more are at their bound.
  double radial_model_px = 2.4;   ///< Sd that the tracker's own errors add to the adjustment's radial coefficient,
  double row_model_px = 0.7;      ///< and to its row.
  double slope_model = 0.01;      ///< Sd of the slope per 100 m that roads add.
  double max_slope = 0.03;        ///< Per 100 m, above which a calibration is not taken over.
  double max_disagreement = 3.0;  ///< In sd, between halves and between the two ways.
  DriveRecorderOptions views;
  BatchOptions batch;
};

void visit_fields(CalibrateOptions& options, FieldVisitor& visitor);

/// A drive of the camera, that can be read again and again.
struct CalibrationDrive {
  std::string name;
  std::function<Result<std::unique_ptr<Sequence>>()> open;
};

/// A parameter, before and after.
struct CalibratedParameter {
  CameraParameter parameter = CameraParameter::kRadial;
  double before = 0.0;
  double after = 0.0;
  double sd = 0.0;     ///< 0 where it stayed.
  std::string reason;  ///< Why it stayed as it was; empty where it changed.
};

/// What one way says of a parameter.
struct ParameterEstimate {
  double value = 0.0;
  double sd = 0.0;
};

struct Calibration {
  CameraPtr camera;  ///< The one to be used: the old one where `adopted` is false.
  bool adopted = false;
  std::string verdict;  ///< In words.
  std::vector<CalibratedParameter> parameters;
  ParameterEstimate radial_by_tracks;                ///< Batch adjustment.
  std::optional<ParameterEstimate> radial_by_slope;  ///< What nulls the slope.
  std::optional<ScaleSlope> slope_before, slope_after;
  double held_out_before_px = 0.0;  ///< Reprojection error of a third of the tracks that took no part,
  double held_out_after_px = 0.0;   ///< with the poses that belong to each camera.
  double turned_deg = 0.0;          ///< All drives together.
  double length_m = 0.0;
  int frames = 0;
  double odometry_s = 0.0;  ///< Time of the odometry's first pass, and of everything.
  double total_s = 0.0;
};

/// The camera's first radial coefficient and principal row from drives, without any truth.
///
/// The keyframe odometry runs without scale correction, a batch adjustment over the whole drive frees both numbers
/// (adjust_batch), and both are repeated with what came out until it stays. Then the slope of the odometry's scale
/// against the ground's (scale_slope) says what is left: the radial coefficient that nulls it follows from the slopes
/// of the passes (secant), and is combined with the adjustment's by their variances. Last the row is adjusted with that
/// coefficient, and a pass with the new camera checks the slope; a third of the tracks, which took no part, the error.
///
/// Each parameter's sd is made of the sandwich over blocks of frames, the disagreement of halves of the tracks and of
/// halves of the drive, and the tracker's own part (..._model_px). A parameter whose halves disagree, that the two ways
/// contradict each other on, or at its bound, stays as it was.
/// @param setup  The camera to begin with; height_m must be set, but says nothing about the result.
/// @return kBadInput as make_odometry; kTooFewMatches: tracks too few for an adjustment. That a drive tells nothing is
///         no error: the verdict says it.
/// Deterministic.
Result<Calibration> calibrate(const std::vector<CalibrationDrive>& drives, const CameraSetup& setup,
                              const OdometryOptions& odometry, const CalibrateOptions& options);

}  // namespace groundscale
