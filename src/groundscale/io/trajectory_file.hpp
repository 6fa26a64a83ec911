#pragma once

#include <string>

#include "groundscale/core/result.hpp"
#include "groundscale/geometry/trajectory.hpp"

namespace groundscale {

/// Reads KITTI rows (12 numbers, world_from_cam) or TUM rows (time tx ty tz qx qy qz qw), told apart by the count.
/// Comments (#) and empty lines are skipped. @return kBadInput with file and line for anything else, NaN included,
/// rotations that are none (beyond 1e-3), and times that fall.
Result<Trajectory> read_trajectory(const std::string& path);

/// One row without the line's end; numbers in the shortest form that reads back to the same bits (up to 17 digits).
std::string kitti_row(const RigidTransform& world_from_cam);
std::string tum_row(double time_s, const RigidTransform& world_from_cam);

/// Written beside and renamed: the file is whole or not there. @return kIo with the system's reason.
Result<void> write_kitti(const std::string& path, const Trajectory& trajectory);
Result<void> write_tum(const std::string& path, const Trajectory& trajectory);

}  // namespace groundscale
