#pragma once

#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/experiment.hpp"
#include "groundscale/experiments/measured_run.hpp"
#include "groundscale/experiments/plot.hpp"
#include "groundscale/experiments/rendered_drive.hpp"
#include "groundscale/experiments/table.hpp"

namespace groundscale::internal {

/// A drive that was simulated, run and evaluated.
struct FinishedDrive {
  std::string name;
  RenderedDrive drive;
  MeasuredRun run;
};

/// A row a drive, all figures.
Table drives_table(const std::vector<FinishedDrive>& drives);
/// The main figures.
std::string drives_overview(const Table& table);
/// For each drive its trajectory and its scale over the distance; for all t_rel by length.
/// @return kIo where a drive's results can't be read again.
Result<std::vector<Plot>> drives_plots(const std::vector<FinishedDrive>& drives);
/// The Markdown file. `problems`: what failed, in words. `drawn`: the figures are there.
std::string drives_report(const std::vector<FinishedDrive>& drives, const std::vector<Plot>& plots,
                          const ExperimentRequest& request, const std::vector<std::string>& problems, bool drawn);

}  // namespace groundscale::internal
