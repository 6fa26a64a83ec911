#include "groundscale/experiments/contender.hpp"

#include <filesystem>
#include <numbers>

#include <fmt/format.h>

#include "groundscale/evaluation/evaluate.hpp"
#include "groundscale/evaluation/figures.hpp"
#include "groundscale/evaluation/steps.hpp"
#include "groundscale/io/trajectory_file.hpp"

namespace groundscale {
namespace {

double length_of(const Trajectory& trajectory) {
  double length_m = 0.0;
  const auto& poses = trajectory.world_from_cam;
  for (std::size_t k = 1; k < poses.size(); ++k) length_m += (poses[k].translation - poses[k - 1].translation).norm();
  return length_m;
}

/// Long enough that a step's own error is small in it, short enough to show drift.
std::vector<PieceRatio> pieces_of(const std::vector<Step>& steps) {
  constexpr double kPieceM = 20.0;
  std::vector<PieceRatio> pieces;
  double estimated_m = 0.0, true_m = 0.0;
  for (const Step& step : steps) {
    estimated_m += step.estimated_m;
    true_m += step.true_m;
    if (true_m < kPieceM) continue;
    pieces.push_back({step.true_distance_m - 0.5 * true_m, estimated_m / true_m});
    estimated_m = true_m = 0.0;
  }
  return pieces;
}

void add_50m(Contender& contender) {
  constexpr double kDegPer100m = 100.0 * 180.0 / std::numbers::pi;
  const auto& errors = contender.measures.over_50m;
  contender.figures["t_rel_50m"] = errors ? std::optional(100.0 * errors->t_rel) : std::nullopt;
  contender.figures["r_rel_50m"] = errors ? std::optional(kDegPer100m * errors->r_rel_rad_per_m) : std::nullopt;
}

}  // namespace

std::optional<double> Contender::figure(const std::string& name) const {
  const auto found = figures.find(name);
  return found == figures.end() ? std::nullopt : found->second;
}

std::vector<double> segment_lengths_m(double path_m) {
  constexpr double kLongM = 1000.0;
  if (path_m >= kLongM) return kitti_lengths_m();
  return {50.0, 100.0, 150.0, 200.0, 250.0, 300.0, 350.0, 400.0};
}

Result<PathMeasures> measure_path(const Trajectory& estimate, const Trajectory& truth,
                                  const RigidTransform& first_from_world) {
  PathMeasures measures;
  const auto errors = kitti_errors(estimate, truth, segment_lengths_m(length_of(truth)));
  if (!errors) return errors.error();
  measures.by_length = errors->by_length;
  const auto short_errors = kitti_errors(estimate, truth, {50.0});
  if (!short_errors) return short_errors.error();
  measures.over_50m = short_errors->all;
  const auto steps = compare_steps(estimate, truth);
  if (!steps) return steps.error();
  measures.pieces = pieces_of(*steps);
  measures.path = estimate;
  for (RigidTransform& pose : measures.path.world_from_cam) pose = first_from_world * pose;
  return measures;
}

Result<Contender> contend_with(const std::string& label, MeasuredRun run, const Trajectory& truth) {
  const auto failed = [](const Error& error) { return Error{ErrorCode::kIo, error.message}; };
  const auto estimate = read_trajectory((std::filesystem::path(run.folder) / "trajectory.kitti").string());
  if (!estimate) return failed(estimate.error());
  auto measures = measure_path(*estimate, truth, estimate->world_from_cam.front().inverse());
  if (!measures) return failed(measures.error());
  Contender contender{
      .label = label, .figures = run.figures, .measures = std::move(*measures), .run = {}, .remark = ""};
  contender.run = std::move(run);
  add_50m(contender);
  return contender;
}

Result<Contender> contend_with(const ComparedSystem& system, const std::string& sequence, const Trajectory& truth) {
  auto compared = read_compared(system, sequence, truth);
  if (!compared) return compared.error();
  PairedDrive paired;
  paired.estimate = compared->path;
  paired.truth = truth;
  const auto evaluation = evaluate(paired, kitti_lengths_m());
  if (!evaluation) return evaluation.error();
  // What is aligned lies in the truth's world already.
  const Trajectory& begins_as = system.sim3 ? truth : compared->path;
  auto measures = measure_path(compared->path, truth, begins_as.world_from_cam.front().inverse());
  if (!measures) return measures.error();
  Contender contender{
      .label = system.label(), .figures = {}, .measures = std::move(*measures), .run = {}, .remark = ""};
  for (const FigureGroup& group : figures_of(*evaluation)) {
    for (const Figure& figure : group.figures) contender.figures[figure.name] = figure.value;
  }
  add_50m(contender);
  if (compared->rows_in_file > truth.size()) {
    contender.remark = fmt::format("the first {} of the {} rows in {}", truth.size(), compared->rows_in_file,
                                   compared_file(system, sequence));
  }
  return contender;
}

}  // namespace groundscale
