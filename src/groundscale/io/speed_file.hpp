#pragma once

#include <string>

#include "groundscale/core/result.hpp"
#include "groundscale/geometry/speed_log.hpp"

namespace groundscale {

/// Speeds of a CSV file: the first line names the columns, `time_s` and `speed_mps` among them (docs/formats.md).
/// @return kBadInput with file, line and value.
Result<SpeedLog> read_speed_csv(const std::string& path);

/// Speeds of a GPX track (1.0 or 1.1), from the positions and times of its points: the way along the WGS84 ellipsoid
/// between two points, as an arc where the track turns, at the time in the middle. Elevations are not used. Times are
/// seconds since 1970-01-01 UTC. Segments of a track, and jumps beyond kMaxSpeedMps, are gaps.
/// @return kBadInput with file, line and value.
Result<SpeedLog> read_gpx(const std::string& path);

/// A track where the name ends in .gpx, in upper case or lower, else a CSV file.
Result<SpeedLog> read_speed_log(const std::string& path);

}  // namespace groundscale
