#pragma once

#include <string>
#include <vector>

#include "calibrate_plan.hpp"
#include "groundscale/calibration/calibrate.hpp"
#include "groundscale/report/calibration_report.hpp"

namespace groundscale {

/// The height at which a drive is looked at where nothing says one: a camera behind the windscreen of a car.
inline constexpr double kAssumedHeightM = 1.5;

/// What a calibration is told as, on the terminal, at the head of the camera file and in the report alike.
class CalibrationWords {
 public:
  using Fact = CalibrationReport::Fact;

  CalibrationWords(const CalibrationPlan& plan, const Calibration& calibration)
      : plan_(plan), calibration_(calibration) {}

  /// Where the camera came from: the start, the height, the drives with their frames.
  std::vector<Fact> origins() const;
  /// Each parameter, before and after.
  std::vector<Fact> parameters() const;
  /// What it rests on.
  std::vector<Fact> evidence() const;
  /// Whether there is a new calibration, why not, and by how much it changes lengths.
  std::string verdict() const;

 private:
  std::string height_text() const;

  const CalibrationPlan& plan_;
  const Calibration& calibration_;
};

/// A line each.
std::string text_of(const std::vector<CalibrationReport::Fact>& facts);

/// @param output  Name of the camera file.
CalibrationReport calibration_report(const CalibrationPlan& plan, const Calibration& calibration,
                                     const std::string& output);

}  // namespace groundscale
