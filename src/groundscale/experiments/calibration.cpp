#include "groundscale/experiments/calibration.hpp"

#include <cctype>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "groundscale/experiments/calibration_report_internal.hpp"
#include "groundscale/experiments/report_parts.hpp"
#include "groundscale/io/files.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::MeasuredPart;

/// All that came of it so far.
struct Progress {
  std::vector<MeasuredPart> parts;
  std::map<std::string, RenderedDrive> drives;  ///< By their names.
  std::vector<std::string> problems;
  std::size_t to_do = 0;  ///< Calibrations.
};

/// "k1 -0.02, cy +5 px" -> "k1-0.02_cy+5px"
std::string folder_name(const CalibrationStart& start) {
  std::string name;
  for (const char c : in_words(start)) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '+' || c == '-' || c == '.') name += c;
    if (c == ',') name += '_';
  }
  return name;
}

/// Rendered when it is needed first.
Result<RenderedDrive> drive_of(const TrialDrive& wanted, const ExperimentRequest& request, Progress& progress) {
  const std::string& name = wanted.choice.name;
  if (const auto found = progress.drives.find(name); found != progress.drives.end()) return found->second;
  auto drive =
      obtain_drive(wanted.choice, wanted.options, (fs::path(request.output) / "drives" / name).string(), request);
  if (drive) progress.drives.emplace(name, *drive);
  return drive;
}

Result<MeasuredTrial> work_on(const std::string& part, const CalibrationPart::Item& item, const RunSettings& settings,
                              const ExperimentRequest& request, Progress& progress) {
  const auto drive = drive_of(item.drive, request, progress);
  if (!drive) return drive.error();
  const std::string folder =
      (fs::path(request.output) / "calibrations" / part / drive->name / folder_name(item.trial.start)).string();
  return measure_trial(*drive, item.trial, settings, folder, request);
}

Result<ExperimentOutcome> report(const Progress& progress, const ExperimentRequest& request) {
  const fs::path output = request.output;
  ExperimentOutcome outcome;
  outcome.report = (output / fmt::format("{}.md", kCalibrationName)).string();
  outcome.problems = progress.problems;
  if (progress.to_do > 0) outcome.problems.push_back(fmt::format("{} calibrations are not done yet", progress.to_do));
  for (const MeasuredPart& part : progress.parts) {
    if (part.trials.empty()) continue;
    const std::string csv = internal::calibration_table(part.trials).csv();
    if (const auto written = write_text((output / (part.name + ".csv")).string(), csv); !written) {
      return written.error();
    }
    outcome.table += fmt::format("{}\n\n{}", part.name, internal::calibration_overview(part));
    for (const Aim& aim : internal::calibration_aims(part)) outcome.table += fmt::format("{}\n", in_words(aim));
    outcome.table += "\n";
  }
  std::vector<std::string> commands;
  for (const auto& [name, drive] : progress.drives) commands.push_back(drive.command);
  const std::string text = internal::calibration_report(progress.parts, commands, outcome.problems, request);
  if (const auto written = write_report(outcome.report, text); !written) return written.error();
  return outcome;
}

}  // namespace

Result<ExperimentOutcome> run_calibration(const CalibrationTrialOptions& options, const RunSettings& settings,
                                          const ExperimentRequest& request) {
  if (const auto valid = settings.validate(); !valid) return valid.error();
  const std::string fisheye_camera = (fs::path(request.output) / "cameras" / "fisheye.yaml").string();
  const auto parts = plan_calibration_parts(options, fisheye_camera);
  if (!parts) return parts.error();
  if (const auto free = check_experiment_folder(kCalibrationName, request); !free) return free.error();
  const auto lock = claim_experiment_folder(kCalibrationName, request);
  if (!lock) return lock.error();
  if (const auto written = write_fisheye_camera(fisheye_camera); !written) return written.error();

  Progress progress;
  for (const CalibrationPart& part : *parts) progress.to_do += part.items.size();
  std::optional<ExperimentOutcome> outcome;
  for (const CalibrationPart& part : *parts) {
    progress.parts.push_back({part.name, part.question, {}});
    for (const CalibrationPart::Item& item : part.items) {
      auto trial = work_on(part.name, item, settings, request, progress);
      --progress.to_do;
      if (trial) {
        progress.parts.back().trials.push_back(std::move(*trial));
      } else {
        progress.problems.push_back(fmt::format("{}, {} from {}: {}", part.name, item.drive.choice.name,
                                                in_words(item.trial.start), trial.error().message));
      }
      auto reported = report(progress, request);
      if (!reported) return reported;
      outcome = std::move(*reported);
    }
  }
  if (outcome && !outcome->table.empty()) return *std::move(outcome);
  return Error{ErrorCode::kIo, fmt::format("no calibration came to its end: {}", fmt::join(progress.problems, "; "))};
}

}  // namespace groundscale
