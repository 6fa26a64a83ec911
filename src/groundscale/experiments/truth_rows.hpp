#pragma once

#include <optional>
#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/geometry/ground_plane.hpp"

namespace groundscale {

/// What `simulate` says of a frame in truth.csv (docs/simulation.md).
struct TruthRow {
  std::optional<GroundPlane> plane;  ///< Of the road in the camera, metres; nothing where no road was fitted.
  double speed_mps = 0.0;
};

/// Rows of a truth.csv, a frame each. @return kIo, kBadInput with file and line.
Result<std::vector<TruthRow>> read_truth_rows(const std::string& path);

}  // namespace groundscale
