#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "groundscale/experiments/calibration.hpp"
#include "groundscale/experiments/calibration_report_internal.hpp"
#include "groundscale/experiments/report_parts.hpp"

namespace groundscale::internal {
namespace {

constexpr double kMaxRadial = 0.002;
constexpr double kMaxRadialPx = 1.0;  ///< 0.002 of KITTI's k1, in the corners.
constexpr double kMaxRowPx = 1.0;
constexpr double kWithinTwoSd = 34.0 / 40.0;
constexpr double kLeastRms = 0.6;
constexpr double kLargestRms = 1.4;

std::vector<Column> number_columns() {
  const auto column = [](const char* name, const char* title, int decimals, bool sign) {
    return Column{.name = name, .title = title, .decimals = decimals, .sign = sign, .averaged = false};
  };
  return {column("radial_start", "k1 off by", 4, true),
          column("radial_error", "k1 error", 5, true),
          column("radial_sd", "k1 sd", 5, false),
          column("radial_in_sd", "k1 error / sd", 2, true),
          column("radial_error_px", "k1 error px", 2, true),
          column("row_start", "cy off by", 1, true),
          column("row_error", "cy error px", 2, true),
          column("row_sd", "cy sd px", 2, false),
          column("row_in_sd", "cy error / sd", 2, true),
          column("row_error_px", "cy error px", 2, true),
          column("focal_start", "f off by %", 2, true),
          column("focal_error", "f error %", 2, true),
          column("focal_sd", "f sd %", 2, false),
          column("focal_in_sd", "f error / sd", 2, true),
          column("focal_error_px", "f error px", 2, true),
          column("tracks_error", "k1 error of tracks", 5, true),
          column("tracks_sd", "its sd", 5, false),
          column("slope_error", "k1 error of slope", 5, true),
          column("slope_sd", "its sd", 5, false),
          column("drift_before", "drift before %/100 m", 1, true),
          column("drift_before_sd", "its sd", 1, false),
          column("drift_after", "drift after %/100 m", 1, true),
          column("drift_after_sd", "its sd", 1, false),
          column("held_out_before_px", "held out before px", 3, false),
          column("held_out_after_px", "held out after px", 3, false),
          column("length_change", "lengths changed %", 2, true),
          column("length_error", "lengths off %", 2, true),
          column("frames", "frames", 0, false),
          column("length_m", "length m", 0, false),
          column("turned_deg", "turned deg", 0, false),
          column("passes", "passes", 0, false),
          column("total_s", "time s", 0, false),
          column("times_one_pass", "time / one pass", 1, false)};
}

/// What the Markdown shows of a part.
std::vector<std::string> shown_in(const std::string& part) {
  std::vector<std::string> names = {"drive", "start", "radial_error", "radial_sd", "row_error", "row_sd"};
  const auto add = [&names](const std::vector<std::string>& more) {
    names.insert(names.end(), more.begin(), more.end());
  };
  if (part == "seeds") add({"radial_in_sd", "row_in_sd"});
  if (part == "fisheye") add({"radial_error_px"});
  if (part == "focal") add({"focal_start", "focal_error", "focal_sd", "length_error"});
  if (part == "range") add({"focal_error"});
  if (part != "focal" && part != "range") add({"tracks_error", "slope_error"});
  add({"drift_before", "drift_after"});
  if (part == "drives" || part == "fisheye") add({"times_one_pass"});
  add({"verdict", "stayed"});
  return names;
}

/// Figures of the trials that took something over.
std::vector<double> figures_of(const std::vector<MeasuredTrial>& trials, const std::string& name) {
  std::vector<double> values;
  for (const MeasuredTrial& trial : trials) {
    if (const auto value = trial.figure(name)) values.push_back(*value);
  }
  return values;
}

/// The largest size of a figure against its bound. What wasn't taken over counts with the error of its start.
Aim at_most(const std::vector<MeasuredTrial>& trials, const std::string& figure, double bound,
            const std::string& what) {
  Aim aim{.what = fmt::format("{} at most {:g} on each drive", what, bound), .met = {}, .measured = ""};
  double largest = -1.0;
  for (const MeasuredTrial& trial : trials) {
    const auto value = trial.figure(figure);
    if (!value || std::abs(*value) <= largest) continue;
    largest = std::abs(*value);
    aim.met = largest <= bound;
    aim.measured = fmt::format("{:.3g} on {} from {}", largest, trial.drive, in_words(trial.start));
  }
  return aim;
}

std::vector<Aim> errors_are_small(const MeasuredPart& part) {
  const bool fisheye = part.name == "fisheye";
  return {fisheye ? at_most(part.trials, "radial_error_px", kMaxRadialPx, "error of k1, px in the corners,")
                  : at_most(part.trials, "radial_error", kMaxRadial, "error of k1"),
          at_most(part.trials, "row_error", kMaxRowPx, "error of cy, px,")};
}

double rms(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares / std::max<double>(1.0, static_cast<double>(values.size())));
}

auto within_two(const std::vector<double>& values) {
  return std::count_if(values.begin(), values.end(), [](double value) { return std::abs(value) <= 2.0; });
}

std::vector<Aim> sds_are_honest(const MeasuredPart& part) {
  const std::vector<double> radial = figures_of(part.trials, "radial_in_sd");
  const std::vector<double> row = figures_of(part.trials, "row_in_sd");
  std::vector<double> both = radial;
  both.insert(both.end(), row.begin(), row.end());
  // What wasn't taken over counts as wrong.
  const auto errors = static_cast<double>(2 * part.trials.size());
  Aim within{.what = fmt::format("of {:g} errors at least {:g} within 2 sd", errors, std::ceil(kWithinTwoSd * errors)),
             .met = {},
             .measured = ""};
  Aim spread{
      .what = fmt::format("rms of error / sd from {:g} to {:g}", kLeastRms, kLargestRms), .met = {}, .measured = ""};
  if (both.empty()) return {within, spread};
  within.met = static_cast<double>(within_two(both)) >= kWithinTwoSd * errors;
  within.measured = fmt::format("{} (k1 {}, cy {})", within_two(both), within_two(radial), within_two(row));
  spread.met = rms(both) >= kLeastRms && rms(both) <= kLargestRms;
  spread.measured = fmt::format("{:.2f} (k1 {:.2f}, cy {:.2f})", rms(both), rms(radial), rms(row));
  return {within, spread};
}

std::vector<Aim> nothing_changes(const MeasuredPart& part) {
  Aim aim{.what = "nothing changes", .met = {}, .measured = ""};
  if (part.trials.empty()) return {aim};
  const auto changed = std::count_if(part.trials.begin(), part.trials.end(), [](const MeasuredTrial& trial) {
    return trial.adopted || trial.figure("radial_error") != trial.figure("radial_start") ||
           trial.figure("row_error") != trial.figure("row_start");
  });
  aim.met = changed == 0;
  aim.measured = fmt::format("{} of {} calibrations changed something", changed, part.trials.size());
  return {aim};
}

}  // namespace

Table calibration_table(const std::vector<MeasuredTrial>& trials) {
  std::vector<Column> columns = {{.name = "drive", .title = "drive", .text = true},
                                 {.name = "start", .title = "start", .text = true}};
  const std::vector<Column> numbers = number_columns();
  columns.insert(columns.end(), numbers.begin(), numbers.end());
  columns.push_back({.name = "verdict", .title = "verdict", .text = true});
  columns.push_back({.name = "stayed", .title = "stayed", .text = true});
  Table table(columns);
  for (const MeasuredTrial& trial : trials) {
    std::vector<Cell> cells = {trial.drive, in_words(trial.start)};
    for (const Column& column : numbers) cells.emplace_back(trial.figure(column.name));
    cells.insert(cells.end(), {trial.verdict, trial.stayed});
    table.add_row(std::move(cells));
  }
  return table;
}

std::string calibration_overview(const MeasuredPart& part) {
  return calibration_table(part.trials).markdown(shown_in(part.name));
}

std::vector<Aim> calibration_aims(const MeasuredPart& part) {
  if (part.name == "seeds") return sds_are_honest(part);
  if (part.name == "straight") return nothing_changes(part);
  if (part.name == "drives" || part.name == "fisheye") return errors_are_small(part);
  return {};
}

std::string calibration_report(const std::vector<MeasuredPart>& parts, const std::vector<std::string>& drives,
                               const std::vector<std::string>& problems, const ExperimentRequest& request) {
  std::string text = fmt::format("# Experiment `{}`: {}\n\n    {}\n\n{}, {}.\n\n", kCalibrationName,
                                 kCalibrationSummary, request.command, program_version(), processor_name());
  text +=
      "Errors are found (where nothing was taken over: the start) less truth. k1 is the first radial coefficient "
      "of any model; its error in px is that of pixels half the image's diagonal from the principal point.\n\n";
  if (!problems.empty()) text += "What is missing:\n\n" + bullet_list(problems);
  for (const MeasuredPart& part : parts) {
    if (part.trials.empty()) continue;
    std::vector<std::string> aims;
    for (const Aim& aim : calibration_aims(part)) aims.push_back(in_words(aim));
    text += fmt::format("## `{0}`\n\n{1} With full precision: `{0}.csv`.\n\n{2}\n{3}", part.name, part.question,
                        calibration_overview(part), bullet_list(aims));
  }
  text += "## Drives\n\n";
  for (const std::string& command : drives) text += fmt::format("    {}\n", command);
  return text;
}

}  // namespace groundscale::internal
