#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/experiment.hpp"
#include "groundscale/experiments/measured_run.hpp"
#include "groundscale/experiments/rendered_drive.hpp"
#include "groundscale/io/camera_file.hpp"

namespace groundscale {

/// What a calibration is told of the focal length.
enum class FocalKnowledge {
  kGiven,   ///< It is taken as it is.
  kWithSd,  ///< It is 1 % (sd) off: freed.
  kView,    ///< The field of view alone: a pinhole whose principal point is the image's middle (--fov).
  kNothing  ///< The same with a focal length that is searched for.
};

/// The camera that a calibration begins with: the true one, and how far it is off.
struct CalibrationStart {
  double radial = 0.0;  ///< Of the first radial coefficient, in its own unit. With kView and kNothing there is none.
  double row_px = 0.0;
  double focal = 0.0;  ///< Share of the focal length.
  FocalKnowledge known = FocalKnowledge::kGiven;
};

/// "k1 -0.02, cy +5 px, f +1 %"
std::string in_words(const CalibrationStart& start);

/// @return kBadInput where there is no such camera.
Result<CameraSetup> start_setup(const CameraSetup& truth, const CalibrationStart& start);

/// A calibration of a camera that is known.
struct CalibrationTrial {
  CalibrationStart start;
  int frames = 0;        ///< At most so many of the drive; 0: all.
  bool lengths = false;  ///< Compare lengths with those that the true camera gives: two more passes of the odometry.
};

/// What came of it. Errors are found (or, where nothing was taken over, start) less truth.
struct MeasuredTrial {
  std::string drive;
  CalibrationStart start;
  /// By the names of docs/experiments.md.
  std::map<std::string, std::optional<double>> figures;
  bool adopted = false;
  std::string verdict;
  std::string stayed;  ///< Which parameters stayed as they were, and why.

  std::optional<double> figure(const std::string& name) const;
};

/// Calibrates from a simulated drive whose true camera lies beside its images, and keeps what came of it in `folder`.
/// Done once while the drive, the trial, the settings and the program (version and bytes) stay the same.
/// @return as calibrate and search_focal; kIo where a kept result can't be read.
Result<MeasuredTrial> measure_trial(const RenderedDrive& drive, const CalibrationTrial& trial,
                                    const RunSettings& settings, const std::string& folder,
                                    const ExperimentRequest& request);

}  // namespace groundscale
