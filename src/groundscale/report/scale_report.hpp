#pragma once

#include <optional>
#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/report/run_folder.hpp"

namespace groundscale {

/// One method's row of a frame in `methods.csv` (docs/formats.md).
struct MethodRow {
  int frame = 0;
  std::optional<double> raw_step_m, raw_step_sd_m, online_step_m;
  std::optional<double> pitch_deg, roll_deg, inliers, time_ms;
  std::string reason;  ///< Why there is no accepted measurement.

  bool accepted() const { return reason.empty() && raw_step_m.has_value(); }
};

/// All rows of a method, in their order.
struct MethodRows {
  std::string method;
  std::vector<MethodRow> rows;
};

/// Reads `methods.csv`: columns by their names, others may be there; methods in the order in which they come.
/// @return kBadInput with file, line and column: a column that is missing, no number where one belongs, no row.
Result<std::vector<MethodRows>> read_methods_table(const std::string& path);

/// Several methods on the same frames as one HTML page.
struct MethodsPage {
  std::string title;
  /// Named facts about the drive, as they are to be shown.
  std::vector<std::pair<std::string, std::string>> facts;
  std::vector<std::string> warnings;
  std::vector<MethodRows> methods;
  /// Length of the step that ends at a frame: the truth's. Empty: the filtered step of the first method stands in.
  std::vector<std::pair<int, double>> true_steps_m;
  std::vector<RunFolder> runs;       ///< What each method has made of the drive, as far as it lies there.
  std::optional<RunFolder> matcher;  ///< The odometry that matched the images, with its sample frames.
};
std::string methods_page_html(const MethodsPage& report);

/// `report.html` of a folder of `scale`, from its methods.csv, the runs in it and, where it is there, its summary.json:
/// of that `source`, `truth`, `warnings` and all else at the top that is a number or text.
/// @return kBadInput as read_methods_table, or for a summary.json that is no JSON; kIo as write_text. A truth that
/// can't be read is said in the report.
Result<void> write_scale_report(const std::string& folder);

}  // namespace groundscale
