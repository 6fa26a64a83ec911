#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "groundscale/report/chart_internal.hpp"
#include "groundscale/report/run_folder.hpp"

namespace groundscale::internal {

/// A run under the name that it has in figures.
struct NamedRun {
  std::string name;
  const RunFolder* run = nullptr;
};

/// From above, each as seen from its own first pose, the truth of the first run that has one beneath. Long drives
/// straight on lie on their side. @pre at least one run.
std::string trajectory_figure(const std::vector<NamedRun>& runs);

std::string step_figure(const RunFolder& run);       ///< Raw and filtered step with its sd.
std::string deviation_figure(const RunFolder& run);  ///< Raw over filtered step, and its sd.
std::string map_figure(const RunFolder& run);        ///< Scale of the map and drift ratio; "" without map.
std::string angle_figure(const RunFolder& run, std::string_view caption = "");  ///< Pitch and roll of the road.
std::string coverage_figure(const RunFolder& run);  ///< Share of frames with a measurement, along the way.
std::string truth_figure(const RunFolder& run);     ///< Steps over true ones; "" without truth.

// Of several runs of one drive, curves over each other:
/// Lengths of pieces of the way over the true ones, or over those of the first run where there is no truth.
std::string pieces_figure(const std::vector<NamedRun>& runs);
std::string sd_figure(const std::vector<NamedRun>& runs);     ///< Standard deviation of the online step, %.
std::string pitch_figure(const std::vector<NamedRun>& runs);  ///< Of the road.
std::string roll_figure(const std::vector<NamedRun>& runs);   ///< Of the road.

/// Raw and filtered steps over those of what a run is compared with, moving ones. @param caption  Text above it.
std::string ratio_figure(const RunFolder& run, const ComparedRun& compared, std::string_view caption);

}  // namespace groundscale::internal
