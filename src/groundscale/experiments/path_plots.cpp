#include "groundscale/experiments/path_plots.hpp"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

namespace groundscale {
namespace {

std::optional<double> value_of(const KittiErrors::OfLength& of_length, PathError error) {
  constexpr double kDegPer100m = 100.0 * 180.0 / std::numbers::pi;
  if (!of_length.errors) return std::nullopt;
  return error == PathError::kTranslation ? 100.0 * of_length.errors->t_rel
                                          : kDegPer100m * of_length.errors->r_rel_rad_per_m;
}

}  // namespace

Trajectory from_first_pose(const Trajectory& trajectory) {
  Trajectory seen = trajectory;
  if (seen.world_from_cam.empty()) return seen;
  const RigidTransform first_from_world = trajectory.world_from_cam.front().inverse();
  for (RigidTransform& pose : seen.world_from_cam) pose = first_from_world * pose;
  return seen;
}

Plot trajectory_plot(const std::string& drive, const std::vector<PlottedPath>& paths) {
  Plot plot{.name = "trajectory-" + drive,
            .title = fmt::format("Drive {} from above", drive),
            .x_label = "x, to the right of the first frame (m)",
            .y_label = "z, ahead of it (m)",
            .columns = {},
            .rows = {},
            .curves = {},
            .equal_axes = true};
  plot.rows.resize(paths.front().path.world_from_cam.size());
  for (const PlottedPath& path : paths) {
    const auto x = static_cast<int>(plot.columns.size());
    plot.columns.insert(plot.columns.end(), {path.name.column + "_x_m", path.name.column + "_z_m"});
    plot.curves.push_back({.title = path.name.title, .x = x, .y = x + 1});
    for (std::size_t k = 0; k < plot.rows.size(); ++k) {
      const Eigen::Vector3d& place = path.path.world_from_cam[k].translation;
      plot.rows[k].emplace_back(place.x());
      plot.rows[k].emplace_back(place.z());
    }
  }
  return plot;
}

Plot length_plot(const std::string& drive, PathError error, const std::vector<PlottedErrors>& errors) {
  const bool translation = error == PathError::kTranslation;
  Plot plot{.name = (translation ? "t_rel-" : "r_rel-") + drive,
            .title = fmt::format("Drive {}: {} over the length of segments (KITTI devkit)", drive,
                                 translation ? "translation error" : "rotation error"),
            .x_label = "length of the segments (m)",
            .y_label = translation ? "t_rel (%)" : "r_rel (deg/100 m)",
            .columns = {"length_m"},
            .rows = {},
            .curves = {},
            .settings = {"set xrange [0:*]", "set yrange [0:*]"}};
  for (const PlottedErrors& one : errors) {
    const auto column = static_cast<int>(plot.columns.size());
    // The colour of its trajectory, where the truth comes first.
    plot.curves.push_back(
        {.title = one.name.title, .x = 0, .y = column, .style = CurveStyle::kLinesPoints, .colour = column});
    plot.columns.push_back(one.name.column);
  }
  if (errors.empty()) return plot;
  for (std::size_t k = 0; k < errors.front().by_length.size(); ++k) {
    std::vector<std::optional<double>> row = {errors.front().by_length[k].length_m};
    for (const PlottedErrors& one : errors) row.push_back(value_of(one.by_length[k], error));
    if (std::any_of(row.begin() + 1, row.end(), [](const auto& value) { return value.has_value(); })) {
      plot.rows.push_back(std::move(row));
    }
  }
  return plot;
}

}  // namespace groundscale
