#pragma once

#include <string>

#include "groundscale/core/result.hpp"
#include "groundscale/odometry/run_writer.hpp"

namespace groundscale {

/// Reads a `summary.json` (docs/formats.md). Keys that older versions didn't write may be missing; the slope's samples
/// and level aren't written at all.
/// @return kBadInput with the path: can't be read, isn't JSON, a value of another type, no `source` or `frames`.
Result<RunSummary> read_run_summary(const std::string& path);

}  // namespace groundscale
