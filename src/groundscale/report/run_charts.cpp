#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "groundscale/report/run_charts_internal.hpp"

namespace groundscale::internal {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kDistance = "distance driven, m";
constexpr double kPieceM = 20.0;

double percent_off(double ratio) { return 100.0 * (ratio - 1.0); }

std::vector<Eigen::Vector3d> positions_from_first(const Trajectory& trajectory) {
  std::vector<Eigen::Vector3d> positions;
  if (trajectory.size() == 0) return positions;
  const RigidTransform first_from_world = trajectory.world_from_cam.front().inverse();
  for (const RigidTransform& pose : trajectory.world_from_cam) positions.push_back(first_from_world * pose.translation);
  return positions;
}

struct SeenPath {
  std::string name;
  std::vector<Eigen::Vector3d> positions;
  int style = 0;
};

/// Whether the way goes ahead farther than to the side by so much that it had better lie on its side.
bool lies_on_its_side(const std::vector<SeenPath>& paths) {
  double side = 0.0;
  double ahead = 0.0;
  for (const SeenPath& path : paths) {
    for (const auto axis : {0, 2}) {
      const auto by_axis = [axis](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a[axis] < b[axis]; };
      const auto [low, high] = std::minmax_element(path.positions.begin(), path.positions.end(), by_axis);
      if (low == path.positions.end()) continue;
      double& extent = axis == 0 ? side : ahead;
      extent = std::max(extent, (*high)[axis] - (*low)[axis]);
    }
  }
  return ahead > side;
}

bool moves(const FrameRow& row) { return row.state.empty() || row.state == "moving"; }

/// Frame numbers of events as places on the way.
std::vector<double> places_of(const RunFolder& run, const std::vector<double>& distances_m) {
  std::vector<double> places;
  for (const ScaleEvent& event : run.summary.corrections) {
    const auto row = std::lower_bound(run.frames.begin(), run.frames.end(), event.frame,
                                      [](const FrameRow& r, int frame) { return r.frame < frame; });
    if (row != run.frames.end()) places.push_back(distances_m[static_cast<std::size_t>(row - run.frames.begin())]);
  }
  return places;
}

/// One way through the rows of a run.
template <class Value>
std::vector<ChartPoint> points_of(const RunFolder& run, Value value) {
  const std::vector<double> distances_m = run.distances_m();
  std::vector<ChartPoint> points;
  for (std::size_t k = 1; k < run.frames.size(); ++k) {
    const std::optional<double> y = value(run.frames[k]);
    points.push_back({distances_m[k], y.value_or(kNone)});
  }
  return points;
}

std::vector<ChartPoint> without_gaps(std::vector<ChartPoint> points) {
  points.erase(std::remove_if(points.begin(), points.end(), [](const ChartPoint& p) { return !std::isfinite(p.y); }),
               points.end());
  return points;
}

bool has_step(const FrameRow& row) { return row.online_step_m && *row.online_step_m > 0.0; }

/// Length of pieces of the way, cut where `along_m` says, over other lengths of them, in percent.
std::vector<ChartPoint> piece_ratios(const std::vector<double>& along_m, const std::vector<double>& steps_m,
                                     const std::vector<double>& others_m) {
  std::vector<ChartPoint> points;
  double own_m = 0.0;
  double other_m = 0.0;
  double begin_m = along_m.empty() ? 0.0 : along_m.front();
  for (std::size_t k = 1; k < along_m.size(); ++k) {
    own_m += steps_m[k];
    other_m += others_m[k];
    if (along_m[k] - begin_m < kPieceM) continue;
    if (other_m > 0.0) points.push_back({0.5 * (begin_m + along_m[k]), percent_off(own_m / other_m)});
    begin_m = along_m[k];
    own_m = other_m = 0.0;
  }
  return points;
}

std::vector<double> final_steps(const RunFolder& run) {
  std::vector<double> steps;
  for (const FrameRow& row : run.frames) steps.push_back(row.step_m.value_or(0.0));
  return steps;
}

std::vector<double> true_steps(const ComparedRun& compared) {
  std::vector<double> steps = {0.0};
  for (const Step& step : compared.steps) steps.push_back(step.true_m);
  return steps;
}

/// An angle of the road by several runs.
std::string angle_figure(const std::vector<NamedRun>& runs, const std::string& angle,
                         std::optional<double> (*of)(const FrameRow&)) {
  Chart chart{.name = angle + " of the road by distance",
              .x_name = kDistance,
              .y_name = angle + ", degrees",
              .bands = {},
              .curves = {},
              .events = {}};
  int style = 0;
  for (const NamedRun& named : runs) {
    const auto accepted = [of](const FrameRow& row) { return row.accepted() ? of(row) : std::nullopt; };
    chart.curves.push_back({.name = named.name,
                            .drawn = mark_of(style),
                            .style = style,
                            .points = without_gaps(points_of(*named.run, accepted))});
    ++style;
  }
  return chart_html(chart, angle + " of the road, accepted measurements");
}

std::vector<double> sums(const std::vector<double>& steps) {
  std::vector<double> along;
  double sum = 0.0;
  for (const double step : steps) along.push_back(sum += step);
  return along;
}

}  // namespace

std::string trajectory_figure(const std::vector<NamedRun>& runs) {
  std::vector<SeenPath> paths;
  for (const NamedRun& named : runs) {
    if (!named.run->compared) continue;
    paths.push_back({"truth", positions_from_first(named.run->compared->paired.truth), kTruthStyle});
    break;
  }
  int style = 0;
  for (const NamedRun& named : runs) {
    paths.push_back({named.name, positions_from_first(named.run->trajectory), style++});
  }
  const bool turned = lies_on_its_side(paths);
  Chart chart{.name = "Trajectory from above",
              .x_name = turned ? "ahead of the first frame, m" : "to the right of the first frame, m",
              .y_name = turned ? "to its right, m" : "ahead of it, m",
              .bands = {},
              .curves = {},
              .events = {},
              .equal_axes = true,
              .y_grows_down = turned};
  ChartCurve begin{.name = "start", .drawn = Drawn::kSquares, .style = 6, .points = {{0.0, 0.0}}};
  for (const SeenPath& path : paths) {
    ChartCurve curve{.name = path.name, .style = path.style, .points = {}};
    for (const Eigen::Vector3d& p : path.positions) {
      curve.points.push_back(turned ? ChartPoint{p.z(), p.x()} : ChartPoint{p.x(), p.z()});
    }
    chart.curves.push_back(std::move(curve));
  }
  chart.curves.push_back(std::move(begin));
  return chart_html(chart, "");
}

std::string step_figure(const RunFolder& run) {
  const auto band_of = [](const FrameRow& row) {
    return has_step(row) && row.online_step_sd_m ? std::optional(2.0 * *row.online_step_sd_m) : std::nullopt;
  };
  Chart chart{.name = "Length of each step by distance",
              .x_name = kDistance,
              .y_name = "step, m a frame",
              .bands = {{"filtered \u00b1 2 sd", {}}},
              .curves = {},
              .events = {}};
  const std::vector<double> distances_m = run.distances_m();
  for (std::size_t k = 1; k < run.frames.size(); ++k) {
    const auto half = band_of(run.frames[k]);
    const double step_m = half ? *run.frames[k].online_step_m : kNone;
    chart.bands[0].ranges.push_back({distances_m[k], step_m - half.value_or(kNone), step_m + half.value_or(kNone)});
  }
  chart.curves = {
      {.name = "measured, refused",
       .drawn = Drawn::kCrosses,
       .style = 4,
       .points =
           without_gaps(points_of(run, [](const FrameRow& r) { return r.accepted() ? std::nullopt : r.raw_step_m; }))},
      {.name = "measured (raw)",
       .drawn = Drawn::kRings,
       .style = 1,
       .points =
           without_gaps(points_of(run, [](const FrameRow& r) { return r.accepted() ? r.raw_step_m : std::nullopt; }))},
      {.name = "filtered (online)", .style = 0, .points = points_of(run, [](const FrameRow& r) {
                                                  return r.online_step_m;
                                                })}};
  return chart_html(chart, "Length of each step");
}

std::string deviation_figure(const RunFolder& run) {
  Chart chart{.name = "Single measurements against the filtered step by distance",
              .x_name = kDistance,
              .y_name = "raw over filtered, %",
              .bands = {{"\u00b1 2 sd of the filtered step", {}}},
              .curves = {},
              .events = {},
              .level = 0.0};
  const std::vector<double> distances_m = run.distances_m();
  for (std::size_t k = 1; k < run.frames.size(); ++k) {
    const FrameRow& row = run.frames[k];
    const double half =
        has_step(row) && row.online_step_sd_m ? 200.0 * *row.online_step_sd_m / *row.online_step_m : kNone;
    chart.bands[0].ranges.push_back({distances_m[k], -half, half});
  }
  const auto off = [](const FrameRow& row, bool accepted) -> std::optional<double> {
    if (!has_step(row) || !row.raw_step_m || row.accepted() != accepted) return std::nullopt;
    return percent_off(*row.raw_step_m / *row.online_step_m);
  };
  chart.curves = {{.name = "refused",
                   .drawn = Drawn::kCrosses,
                   .style = 4,
                   .points = without_gaps(points_of(run, [&](const FrameRow& r) { return off(r, false); }))},
                  {.name = "accepted",
                   .drawn = Drawn::kRings,
                   .style = 1,
                   .points = without_gaps(points_of(run, [&](const FrameRow& r) { return off(r, true); }))}};
  return chart_html(chart, "Single measurements against the filtered step");
}

std::string map_figure(const RunFolder& run) {
  const auto scale = points_of(run, [](const FrameRow& r) { return r.map_scale; });
  const auto ratio = without_gaps(points_of(run, [](const FrameRow& r) { return r.drift_ratio; }));
  if (without_gaps(scale).empty()) return "";
  const std::vector<double> events = places_of(run, run.distances_m());
  Chart scales{.name = "Metres per unit of the map by distance",
               .x_name = kDistance,
               .y_name = "m per map unit",
               .height = 190.0,
               .bands = {},
               .curves = {{.name = "metres per unit of the map", .style = 0, .points = scale}},
               .events = events,
               .event_name = "map scaled"};
  Chart ratios{
      .name = "Drift ratio by distance",
      .x_name = kDistance,
      .y_name = "drift ratio",
      .height = 190.0,
      .bands = {},
      .curves = {{.name = "measured scale over the one in force", .drawn = Drawn::kRings, .style = 1, .points = ratio}},
      .events = events,
      .event_name = "map scaled",
      .level = 1.0};
  return chart_html(scales, "Scale in force") + chart_html(ratios, "Drift ratio");
}

std::string angle_figure(const RunFolder& run, std::string_view caption) {
  const auto accepted = [](const FrameRow& row, const std::optional<double>& angle) {
    return row.accepted() ? angle : std::nullopt;
  };
  const Chart chart{
      .name = "Pitch and roll of the road by distance",
      .x_name = kDistance,
      .y_name = "degrees",
      .bands = {},
      .curves = {{.name = "pitch",
                  .drawn = Drawn::kDots,
                  .style = 0,
                  .points = without_gaps(points_of(run, [&](const FrameRow& r) { return accepted(r, r.pitch_deg); }))},
                 {.name = "roll",
                  .drawn = Drawn::kCrosses,
                  .style = 1,
                  .points = without_gaps(points_of(run, [&](const FrameRow& r) { return accepted(r, r.roll_deg); }))}},
      .events = {}};
  return chart_html(chart, caption);
}

std::string coverage_figure(const RunFolder& run) {
  // By frames, so that places where the vehicle stood or no scale is known show too.
  constexpr std::size_t kPieces = 60;
  ChartCurve curve{.name = "", .style = 0, .points = {}};
  ChartBand band{.name = "frames with an accepted measurement", .ranges = {}};
  const std::size_t pieces = std::min(kPieces, run.frames.size());
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    const std::size_t begin = piece * run.frames.size() / pieces;
    const std::size_t end = (piece + 1) * run.frames.size() / pieces;
    double accepted = 0.0;
    for (std::size_t k = begin; k < end; ++k) accepted += run.frames[k].accepted() ? 1.0 : 0.0;
    const double share = 100.0 * accepted / static_cast<double>(end - begin);
    for (const std::size_t k : {begin, end - 1}) {
      const double frame = run.frames[k].frame + (k == begin ? -0.5 : 0.5);
      band.ranges.push_back({frame, 0.0, share});
      curve.points.push_back({frame, share});
    }
  }
  const Chart chart{.name = "Share of frames with an accepted measurement along the drive",
                    .x_name = "frame",
                    .y_name = "measured, %",
                    .height = 130.0,
                    .bands = {band},
                    .curves = {curve},
                    .events = {},
                    .level = 100.0};
  return chart_html(chart, "");
}

std::string truth_figure(const RunFolder& run) {
  if (!run.compared) return "";
  const ComparedRun& compared = *run.compared;
  Chart chart{.name = "Steps over true ones by distance",
              .x_name = "true distance, m",
              .y_name = "over true, %",
              .bands = {},
              .curves = {{.name = "measured (raw)", .drawn = Drawn::kRings, .style = 1, .points = {}},
                         {.name = "filtered (online)", .style = 2, .points = {}},
                         {.name = "final", .style = 0, .points = {}}},
              .events = {},
              .level = 0.0};
  for (std::size_t k = 0; k < compared.steps.size(); ++k) {
    const Step& step = compared.steps[k];
    if (!step.moving) continue;
    const FrameRow& row = compared.paired.frames[k + 1];
    const auto add = [&](std::size_t curve, double step_m) {
      chart.curves[curve].points.push_back({step.true_distance_m, percent_off(step_m / step.true_m)});
    };
    if (row.accepted()) add(0, *row.raw_step_m);
    if (row.online_step_m) add(1, *row.online_step_m);
    add(2, step.estimated_m);
  }
  return chart_html(chart, "Each moving step over the true one");
}

std::string pieces_figure(const std::vector<NamedRun>& runs) {
  const RunFolder& first = *runs.front().run;
  const bool by_truth = std::all_of(runs.begin(), runs.end(), [](const NamedRun& r) { return r.run->compared; });
  if (!by_truth && runs.size() < 2) return "";
  const std::vector<double> first_steps = final_steps(first);
  Chart chart{.name = "Lengths of pieces of the way",
              .x_name = by_truth ? "true distance, m" : kDistance,
              .y_name = by_truth ? "over true, %" : "over first, %",
              .bands = {},
              .curves = {},
              .events = {},
              .level = 0.0};
  int style = 0;
  for (const NamedRun& named : runs) {
    ChartCurve curve{.name = named.name, .style = style++, .points = {}};
    const std::vector<double> own = final_steps(*named.run);
    std::vector<double> others = by_truth ? true_steps(*named.run->compared) : first_steps;
    others.resize(own.size(), 0.0);
    if (by_truth || named.run != &first) curve.points = piece_ratios(sums(others), own, others);
    chart.curves.push_back(std::move(curve));
  }
  return chart_html(chart, fmt::format("Pieces of {:.0f} m of the final trajectories over {}", kPieceM,
                                       by_truth ? "the true ones" : "those of " + runs.front().name));
}

std::string sd_figure(const std::vector<NamedRun>& runs) {
  Chart chart{.name = "Standard deviation of the online step by distance",
              .x_name = kDistance,
              .y_name = "sd of the step, %",
              .bands = {},
              .curves = {},
              .events = {}};
  int style = 0;
  for (const NamedRun& named : runs) {
    chart.curves.push_back({.name = named.name,
                            .style = style++,
                            .points = points_of(*named.run, [](const FrameRow& r) -> std::optional<double> {
                              if (!has_step(r) || !r.online_step_sd_m || !moves(r)) return std::nullopt;
                              return 100.0 * *r.online_step_sd_m / *r.online_step_m;
                            })});
  }
  return chart_html(chart, "Uncertainty of the filtered (online) step");
}

std::string pitch_figure(const std::vector<NamedRun>& runs) {
  return angle_figure(runs, "Pitch", [](const FrameRow& row) { return row.pitch_deg; });
}

std::string roll_figure(const std::vector<NamedRun>& runs) {
  return angle_figure(runs, "Roll", [](const FrameRow& row) { return row.roll_deg; });
}

std::string ratio_figure(const RunFolder& run, const ComparedRun& compared, std::string_view caption) {
  Chart chart{.name = "Steps over those of the reference by distance",
              .x_name = "distance, m",
              .y_name = "step ratio - 1, %",
              .bands = {},
              .curves = {{.name = "raw, refused", .drawn = Drawn::kCrosses, .style = 4, .points = {}},
                         {.name = "raw", .drawn = Drawn::kRings, .style = 1, .points = {}},
                         {.name = "filtered", .style = 0, .points = {}}},
              .events = {},
              .level = 0.0};
  for (std::size_t k = 0; k < compared.steps.size(); ++k) {
    const Step& step = compared.steps[k];
    if (!step.moving) continue;
    const FrameRow& row = run.frames[k + 1];
    const auto add = [&](std::size_t curve, double step_m) {
      chart.curves[curve].points.push_back({step.true_distance_m, percent_off(step_m / step.true_m)});
    };
    if (row.raw_step_m) add(row.accepted() ? 1 : 0, *row.raw_step_m);
    if (row.online_step_m) add(2, *row.online_step_m);
  }
  return chart_html(chart, caption);
}

}  // namespace groundscale::internal
