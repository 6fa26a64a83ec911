#pragma once

#include <optional>
#include <string>
#include <vector>

#include "groundscale/experiments/contest.hpp"
#include "groundscale/experiments/plot.hpp"
#include "groundscale/experiments/table.hpp"

namespace groundscale::internal {

/// The same run with other random numbers.
struct SeedRuns {
  std::string drive;
  std::string mode;
  std::vector<Contender> runs;  ///< Labels are the seeds.
  /// Whether the run with the experiment's own seed gave the same trajectory and frames.csv a second time.
  std::optional<bool> same_bytes;
};

/// All that came of a contest so far.
struct ContestResult {
  std::vector<ContestedDrive> drives;
  SeedRuns seeds;
  std::vector<Aim> aims;
  std::vector<std::string> problems;
  std::vector<std::string> remarks;  ///< On what was asked for, beyond those of the contenders.
};

/// A row a drive and trajectory, then the means of each over its drives.
Table contest_table(const std::vector<ContestedDrive>& drives);
Table seeds_table(const SeedRuns& seeds);
std::string contest_overview(const Table& table);
/// For each drive: trajectories from above, errors over length, scale over the distance.
std::vector<Plot> contest_plots(const std::vector<ContestedDrive>& drives);
/// The Markdown file. `drawn`: the figures are there.
std::string contest_report(const Contest& contest, const ContestResult& result, const std::vector<Plot>& plots,
                           const ExperimentRequest& request, bool drawn);

}  // namespace groundscale::internal
