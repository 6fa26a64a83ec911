#pragma once

#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/report/run_folder.hpp"

namespace groundscale {

/// A run as one HTML page that needs nothing else: figures inside as SVG, pictures inside too, no scripts, for screens
/// of any width and for paper. What it shows, and the rules of its verdict: docs/report.md. The same bytes for the same
/// run.
std::string run_report_html(const RunFolder& run);

/// `report.html` of a run's folder. @return errors of read_run_folder; kIo, as write_text.
Result<void> write_run_report(const std::string& folder);

/// Several runs beside each other: figures in one table, curves of runs of the same drive over each other, each run's
/// verdict. That runs are of different drives is said. @pre at least two runs.
std::string comparison_html(const std::vector<RunFolder>& runs);

}  // namespace groundscale
