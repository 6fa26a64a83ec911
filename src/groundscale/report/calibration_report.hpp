#pragma once

#include <optional>
#include <string>
#include <vector>

#include "groundscale/calibration/residual_map.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/odometry/scale_slope.hpp"

namespace groundscale {

/// What there is to say of a camera's calibration. What is empty is left out.
struct CalibrationReport {
  struct Parameter {
    std::string name;  ///< As in the camera file.
    std::string unit;
    double before = 0.0;
    double after = 0.0;
    double sd = 0.0;     ///< 0: none is stated.
    std::string reason;  ///< Why it stayed as it was.
  };
  struct Fact {
    std::string label;
    std::string value;
  };
  /// How the scale ran away in one drive.
  struct Drift {
    std::string drive;
    std::optional<ScaleSlope> before, after;
  };

  std::string title;
  std::string verdict;   ///< In words.
  bool adopted = false;  ///< Whether there is a new camera.
  std::vector<Parameter> parameters;
  std::vector<Fact> facts;
  std::optional<ResidualMap> residuals_before, residuals_after;
  std::vector<Drift> drifts;
  std::string camera_before, camera_after;  ///< Text of the camera files.
};

/// The report as one HTML page that needs nothing else: figures inside as SVG, no scripts, for screens of any width and
/// for paper. The same bytes for the same report.
std::string calibration_report_html(const CalibrationReport& report);

/// @return kIo, as write_text.
Result<void> write_calibration_report(const std::string& path, const CalibrationReport& report);

}  // namespace groundscale
