#pragma once

#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/plot.hpp"

namespace groundscale {

/// Pieces that the reports of experiments have in common.

/// Draws into `figures` of an experiment's folder: data and scripts in any case, pictures where gnuplot is there.
/// @param plots     Those without a point are taken out: there is nothing to draw.
/// @param problems  What fails is added, in words.
/// @return whether all pictures are there.
bool write_figures(const std::string& output, std::vector<Plot>& plots, std::vector<std::string>& problems);

/// The section with all figures, or with their scripts where they aren't drawn; "" without any.
std::string figures_section(const std::vector<Plot>& plots, bool drawn);

/// Writes an experiment's report: the Markdown, and `report.html` beside it, which holds its figures as well.
/// @param path  Of the Markdown file. @return kIo.
Result<void> write_report(const std::string& path, const std::string& markdown);

/// A line an item and an empty one below; "" without items.
std::string bullet_list(const std::vector<std::string>& items);

/// Each item once, in the order in which they come.
std::string distinct(const std::vector<std::string>& items);

}  // namespace groundscale
