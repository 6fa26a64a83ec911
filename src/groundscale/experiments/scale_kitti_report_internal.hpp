#pragma once

#include <optional>
#include <string>
#include <vector>

#include "groundscale/evaluation/evaluate.hpp"
#include "groundscale/experiments/experiment.hpp"
#include "groundscale/experiments/plot.hpp"
#include "groundscale/experiments/rendered_drive.hpp"
#include "groundscale/experiments/table.hpp"

namespace groundscale::internal {

/// Where the ground is measured, and how it is filtered.
struct ScaleSetting {
  std::string region;  ///< "fixed" or "path".
  std::string filter;  ///< "none", "paper" or "model".

  bool operator==(const ScaleSetting&) const = default;
};

/// One method on one drive in one setting.
struct ScaleRow {
  std::string drive;
  bool real = false;
  ScaleSetting setting;
  std::string method;
  ScaleFigures scale{};
  std::optional<double> coverage{};  ///< Share of moving steps with an accepted measurement.
  std::optional<double> time_ms{};   ///< Median a frame, of the method alone.
};

/// What has been measured so far.
struct ScaleKittiResult {
  std::vector<RenderedDrive> drives;
  std::vector<ScaleRow> rows;
  std::vector<std::string> commands;
  std::vector<std::string> problems;
};

Table scale_table(const std::vector<ScaleRow>& rows);
/// Mean scale error: rows are methods in a setting, columns the drives.
std::string scale_overview(const ScaleKittiResult& result);
/// A figure a setting: a line a method over the drives.
std::vector<Plot> scale_plots(const ScaleKittiResult& result);
std::string scale_kitti_report(const ScaleKittiResult& result, const std::vector<Plot>& plots,
                               const ExperimentRequest& request, bool drawn);

}  // namespace groundscale::internal
