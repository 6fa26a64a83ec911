#pragma once

#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/io/sequence.hpp"
#include "groundscale/odometry/frame_result.hpp"
#include "groundscale/scale/speed_reference.hpp"

namespace groundscale {

/// Before a drive: whether the log knows anything of it.
/// @return kBadInput where the two have no time in common.
Result<void> check_overlap(const SpeedReference& speed, const TimeSpan& drive);

/// After a drive, in words: frames that the log knows nothing of, speeds that differ from those by the ground (with the
/// unit that they may be in), and a scale that is the log's alone.
std::vector<std::string> speed_warnings(const SpeedReference& speed, const std::vector<FrameResult>& results);

}  // namespace groundscale
