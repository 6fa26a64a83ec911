#pragma once

#include <string>
#include <vector>

#include "groundscale/core/result.hpp"

namespace groundscale {

/// Ways to run the odometry that experiments set beside each other: those of odometry.scale_correction, all in keyframe
/// mode, and `pairwise`.
std::vector<std::string> mode_names();

/// What `run` does where nothing is said.
std::string default_mode();

/// @param wanted  Empty: `none`, then the default mode.
/// @return kBadInput for a name that is none, or is there twice.
Result<std::vector<std::string>> choose_modes(const std::vector<std::string>& wanted);

/// The mode that speaks for the program: the default one where it is among them, else the last. @pre not empty.
std::string best_mode(const std::vector<std::string>& modes);

/// KEY=VALUE of the configuration.
std::vector<std::string> mode_assignments(const std::string& mode);

}  // namespace groundscale
