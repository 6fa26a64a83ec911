#include "groundscale/evaluation/evaluate.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "groundscale/evaluation/statistics_internal.hpp"

namespace groundscale {
namespace {

/// A step's own length by another source than the poses; nothing where it has none.
using StepValue = std::optional<double>;

ScaleFigures scale_figures(const std::vector<Step>& steps, const std::vector<StepValue>& values_m) {
  std::vector<double> all;
  std::vector<double> straight;
  std::vector<double> turn;
  std::vector<RatioAt> along;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (!steps[k].moving || !values_m[k]) continue;
    const double ratio = *values_m[k] / steps[k].true_m;
    all.push_back(ratio);
    (steps[k].turn ? turn : straight).push_back(ratio);
    along.push_back({steps[k].true_distance_m, ratio});
  }
  return {static_cast<int>(all.size()), scale_errors(all), scale_errors(straight), scale_errors(turn),
          scale_drift(along)};
}

std::vector<StepValue> estimated_lengths(const std::vector<Step>& steps) {
  std::vector<StepValue> values_m;
  values_m.reserve(steps.size());
  for (const Step& step : steps) values_m.emplace_back(step.estimated_m);
  return values_m;
}

Result<PathFigures> path_figures(const std::vector<Step>& steps, const Trajectory& estimate, const Trajectory& truth,
                                 const std::vector<double>& lengths_m) {
  Result<KittiErrors> kitti = kitti_errors(estimate, truth, lengths_m);
  if (!kitti) return kitti.error();
  PathFigures figures;
  std::vector<double> rotation_errors_rad;
  for (const Step& step : steps) {
    figures.estimated_m += step.estimated_m;
    figures.true_m += step.true_m;
    rotation_errors_rad.push_back(step.rotation_error_rad);
  }
  figures.rotations = static_cast<int>(steps.size());
  figures.rotation_error_rad = internal::median(rotation_errors_rad);
  figures.kitti = std::move(*kitti);
  if (const auto absolute = absolute_errors(estimate, truth)) figures.absolute = *absolute;
  return figures;
}

void count(Share& share, bool hit) {
  ++share.of;
  if (hit) ++share.count;
}

void count(SdShares& shares, const Step& step, bool hit) {
  count(shares.all, hit);
  count(step.turn ? shares.turn : shares.straight, hit);
}

bool within_2_sd(double value_m, double true_m, double sd_m) { return std::abs(value_m - true_m) <= 2.0 * sd_m; }

/// @param frames  One more than steps; frame k + 1 is the one that step k ends at.
Coverage coverage_of(const std::vector<Step>& steps, const std::vector<FrameRow>& frames) {
  Coverage coverage;
  const auto first = std::find_if(frames.begin(), frames.end(), [](const FrameRow& row) { return row.accepted(); });
  if (first != frames.end()) {
    coverage.first_accepted_frame = first->frame;
    coverage.moving_steps_before_first = 0;
  }
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const Step& step = steps[k];
    const FrameRow& row = frames[k + 1];
    if (!step.moving) continue;
    count(coverage.accepted, row.accepted());
    count(coverage.filtered, row.step_sd_m.has_value());
    if (first != frames.end()) {
      if (row.frame >= first->frame) {
        count(coverage.filtered_after_first, row.step_sd_m.has_value());
      } else {
        ++*coverage.moving_steps_before_first;
      }
    }
    if (row.step_sd_m) count(coverage.within_2_sd, step, within_2_sd(step.estimated_m, step.true_m, *row.step_sd_m));
    if (row.online_step_m && row.online_step_sd_m) {
      count(coverage.online_within_2_sd, step, within_2_sd(*row.online_step_m, step.true_m, *row.online_step_sd_m));
    }
    if (row.accepted() && row.raw_step_sd_m) {
      count(coverage.raw_within_2_sd, within_2_sd(*row.raw_step_m, step.true_m, *row.raw_step_sd_m));
    }
  }
  return coverage;
}

Result<void> add_online(const PairedDrive& drive, const std::vector<double>& lengths_m, const StepRules& rules,
                        const std::vector<Step>& steps, Evaluation& evaluation) {
  if (drive.online) {
    const Result<std::vector<Step>> online_steps = compare_steps(*drive.online, drive.truth, rules);
    if (!online_steps) return online_steps.error();
    Result<PathFigures> path = path_figures(*online_steps, *drive.online, drive.truth, lengths_m);
    if (!path) return path.error();
    evaluation.online_path = std::move(*path);
    evaluation.online_scale = scale_figures(*online_steps, estimated_lengths(*online_steps));
    return {};
  }
  std::vector<StepValue> values_m;
  for (std::size_t k = 0; k < steps.size(); ++k) values_m.push_back(drive.frames[k + 1].online_step_m);
  evaluation.online_scale = scale_figures(steps, values_m);
  return {};
}

}  // namespace

Result<Evaluation> evaluate(const PairedDrive& drive, const std::vector<double>& lengths_m, const StepRules& rules) {
  Result<std::vector<Step>> compared = compare_steps(drive.estimate, drive.truth, rules);
  if (!compared) return compared.error();
  const std::vector<Step>& steps = *compared;
  Evaluation evaluation;
  evaluation.rows = drive.estimate.size();
  for (const Step& step : steps) {
    if (step.moving) ++evaluation.moving_steps;
    if (step.moving && step.turn) ++evaluation.turn_steps;
  }
  if (evaluation.moving_steps == 0) {
    return Error{
        ErrorCode::kBadInput,
        fmt::format("the truth stands still: none of its {} steps is {}, there is nothing to measure", steps.size(),
                    drive.truth.has_times() ? fmt::format("faster than {} m/s", rules.min_speed_mps)
                                            : fmt::format("longer than {} m", rules.min_step_m))};
  }
  evaluation.scale = scale_figures(steps, estimated_lengths(steps));
  Result<PathFigures> path = path_figures(steps, drive.estimate, drive.truth, lengths_m);
  if (!path) return path.error();
  evaluation.path = std::move(*path);
  if (drive.frames.empty()) return evaluation;

  GS_CHECK(drive.frames.size() == steps.size() + 1, "a row of frames.csv for every pose");
  if (const auto added = add_online(drive, lengths_m, rules, steps, evaluation); !added) return added.error();
  std::vector<StepValue> raw_m;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const FrameRow& row = drive.frames[k + 1];
    raw_m.push_back(row.accepted() ? row.raw_step_m : std::nullopt);
  }
  evaluation.raw_scale = scale_figures(steps, raw_m);
  evaluation.coverage = coverage_of(steps, drive.frames);
  return evaluation;
}

}  // namespace groundscale
