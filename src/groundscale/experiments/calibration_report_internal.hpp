#pragma once

#include <string>
#include <vector>

#include "groundscale/experiments/aims.hpp"
#include "groundscale/experiments/calibration_trial.hpp"
#include "groundscale/experiments/experiment.hpp"
#include "groundscale/experiments/table.hpp"

namespace groundscale::internal {

/// A part with what came of it so far.
struct MeasuredPart {
  std::string name;
  std::string question;
  std::vector<MeasuredTrial> trials;
};

/// A row a calibration, all figures.
Table calibration_table(const std::vector<MeasuredTrial>& trials);
/// The figures that matter in a part, as Markdown.
std::string calibration_overview(const MeasuredPart& part);
/// What is to be reached in a part; nothing where a part only states what there is.
std::vector<Aim> calibration_aims(const MeasuredPart& part);
/// The Markdown file. `drives`: the commands that make them. `problems`: what failed, in words.
std::string calibration_report(const std::vector<MeasuredPart>& parts, const std::vector<std::string>& drives,
                               const std::vector<std::string>& problems, const ExperimentRequest& request);

}  // namespace groundscale::internal
