#pragma once

#include <string>
#include <vector>

#include "groundscale/core/result.hpp"

namespace groundscale {

/// Whether a command may write its --output: the folder is there, none of the files exists unless `force` says that
/// they may be written over, and none is read by the command, which `force` doesn't change.
/// @param outputs  The first is the one that --output names.
/// @param inputs  Empty ones are passed over.
Result<void> check_output_files(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs,
                                bool force);

}  // namespace groundscale
