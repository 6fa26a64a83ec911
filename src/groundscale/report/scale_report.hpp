#pragma once

#include <optional>
#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/report/run_folder.hpp"
#include "groundscale/report/run_verdict.hpp"

namespace groundscale {

/// What a method needed in each frame in which it was asked, by `methods.csv` (docs/formats.md).
struct MethodTimes {
  std::string method;
  std::vector<double> time_ms;
};

/// Reads `methods.csv`: columns by their names, others may be there; methods in the order in which they come.
/// @return kBadInput with file, line and column: a column that is missing, no number where one belongs, no row.
Result<std::vector<MethodTimes>> read_method_times(const std::string& path);

/// What one of several methods has made of a drive.
struct MethodRun {
  MethodTimes times;
  RunFolder run;
  /// Beside the filtered path of the first method, where there is no truth to compare with; empty where that never got
  /// a scale.
  std::optional<ComparedRun> beside_first;

  const std::string& name() const { return times.method; }
  /// With the truth; else with the first method; nothing where neither is to be had.
  const ComparedRun* compared() const;
};

/// Several methods on the same frames.
struct MethodsReport {
  RunFolder matcher;  ///< The odometry that matched the images, with its sample frames.
  std::vector<MethodRun> methods;

  bool by_truth() const { return !methods.empty() && methods.front().run.compared.has_value(); }
};

/// What `scale` left in a folder. @return errors of read_method_times and read_run_folder.
Result<MethodsReport> read_methods_report(const std::string& folder);

/// Which method is nearest to the truth, and a finding a method, by the rules of docs/report.md.
RunVerdict verdict_of(const MethodsReport& report);

/// As one HTML page, like run_report_html. Errors are those of `evaluate`.
std::string methods_page_html(const MethodsReport& report);

/// `report.html` of a folder of `scale`. @return errors of read_methods_report; kIo as write_text.
Result<void> write_scale_report(const std::string& folder);

}  // namespace groundscale
