#include "groundscale/experiments/vo_kitti.hpp"

#include "groundscale/experiments/odometry_modes.hpp"

namespace groundscale {

Result<ExperimentOutcome> run_vo_kitti(ContestOptions options, const RunSettings& settings,
                                       const ExperimentRequest& request) {
  options.drives.default_sequences = {"03", "06", "07", "10", "00:1501"};
  Contest contest{.name = kVoKittiName, .summary = kVoKittiSummary, .aims = drift_aims};
  if (!options.distortion) return run_contest(contest, options, settings, request);
  if (options.modes.empty()) options.modes = {"none", "triggered", default_mode()};
  contest.aims = [](const std::vector<ContestedDrive>& drives, const std::string&) { return distortion_aims(drives); };
  return run_contest(contest, options, settings, request);
}

Result<ExperimentOutcome> run_campus(ContestOptions options, const RunSettings& settings,
                                     const ExperimentRequest& request) {
  options.drives.preset = "campus";
  // One minute: the first turn and more.
  if (options.drives.sequences.empty()) options.drives.sequences = {"city:1800"};
  return run_contest({.name = kCampusName, .summary = kCampusSummary, .aims = campus_aims}, options, settings, request);
}

}  // namespace groundscale
