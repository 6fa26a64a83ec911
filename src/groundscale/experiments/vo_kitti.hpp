#pragma once

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/contest.hpp"

namespace groundscale {

inline constexpr const char* kVoKittiName = "vo-kitti";
inline constexpr const char* kVoKittiSummary =
    "trajectories without and with scale correction on KITTI's sequences, real or simulated, and those of other "
    "systems";

/// The experiment `vo-kitti` (docs/experiments.md), after the figures of Zhou, Dai, Li 2019. @return as run_contest.
Result<ExperimentOutcome> run_vo_kitti(ContestOptions options, const RunSettings& settings,
                                       const ExperimentRequest& request);

inline constexpr const char* kCampusName = "campus";
inline constexpr const char* kCampusSummary =
    "a fisheye camera that looks to the side, without and with scale correction";

/// The experiment `campus` (docs/experiments.md): the same on routes seen by the preset `campus`.
/// @return as run_contest.
Result<ExperimentOutcome> run_campus(ContestOptions options, const RunSettings& settings,
                                     const ExperimentRequest& request);

}  // namespace groundscale
