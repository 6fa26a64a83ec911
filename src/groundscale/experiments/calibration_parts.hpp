#pragma once

#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/calibration_trial.hpp"
#include "groundscale/experiments/drive_choice.hpp"

namespace groundscale {

struct CalibrationTrialOptions {
  std::vector<std::string> parts{};      ///< Of calibration_part_names; empty: all.
  std::string kitti{};                   ///< As in DriveOptions: poses that `drives` and `focal` follow too; "": none.
  std::vector<std::string> sequences{};  ///< Of `kitti`.
  std::string preset = "small";          ///< Camera of the short drives: parts `seeds` and `straight`.
  int frames = 250;                      ///< Of the short drives, and of `range` and `fisheye`.
  int seeds = 20;                        ///< How many worlds, from seed 1 on.
  int threads = 0;                       ///< For rendering; 0: one a processor.
};

/// A drive to be simulated.
struct TrialDrive {
  DriveChoice choice;
  DriveOptions options;
};

/// A part of the experiment: calibrations that answer one question, and a table.
struct CalibrationPart {
  struct Item {
    TrialDrive drive;
    CalibrationTrial trial;
  };
  std::string name;
  std::string question;  ///< A sentence or two, for the report.
  std::vector<Item> items;
};

std::vector<std::string> calibration_part_names();

/// What is tried, part by part. Each part is a function of calibration_parts.cpp.
/// @param fisheye_camera  Where the camera file of part `fisheye` is, or will be (write_fisheye_camera).
/// @return kBadInput: unknown part, or what is wrong with the drives.
Result<std::vector<CalibrationPart>> plan_calibration_parts(const CalibrationTrialOptions& options,
                                                            const std::string& fisheye_camera);

/// A camera that looks ahead over 130 degrees (Kannala-Brandt). @return kIo.
Result<void> write_fisheye_camera(const std::string& path);

}  // namespace groundscale
