#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "drive_source.hpp"
#include "groundscale/calibration/drive_pass.hpp"
#include "groundscale/core/result.hpp"

namespace groundscale {

struct CalibrateArguments {
  std::vector<std::string> sources;
  SourceArguments source;  ///< Of each of them.
  std::optional<double> fov_deg;
  std::string output;
  bool force = false;
  bool quiet = false;
};

/// What is to be calibrated: the camera to begin with, and the drives that all have it.
struct CalibrationPlan {
  struct Drive {
    std::string source;
    int first_frame = 0;
    int frames = 0;           ///< As declared.
    std::string calibration;  ///< That lies with the images, or "".
  };

  RunConfig config;
  CameraChoice camera;          ///< Its height is empty where nothing says it.
  bool focal_known = true;      ///< False: a pinhole that --fov or nothing at all says.
  bool focal_searched = false;  ///< Its focal length is still to be found.
  std::vector<Drive> drives;
  std::vector<CalibrationDrive> readers;            ///< Of them.
  std::shared_ptr<std::set<std::string>> warnings;  ///< Of reading them, as far as they were read.
  int frames() const;
};

/// A pinhole without distortion, its principal point in the image's middle.
Result<CameraPtr> plain_pinhole(double focal_px, int width, int height);

/// Looks at everything that can be known before the work. @return kBadInput; kIo as open_sequence.
Result<CalibrationPlan> make_calibration_plan(const CalibrateArguments& arguments);

}  // namespace groundscale
