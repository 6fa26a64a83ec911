#pragma once

#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/drive_choice.hpp"
#include "groundscale/geometry/trajectory.hpp"

namespace groundscale {

/// Another system's trajectories, to be set beside ours: NAME=POSES or NAME@sim3=POSES.
struct ComparedSystem {
  std::string name;
  bool sim3 = false;  ///< It knows no scale: the truth gives it scale, place and direction, and its label says so.
  /// KITTI rows, row i is frame i: a file; a folder with SEQUENCE.txt; or a path with {} for the sequence.
  std::string poses;

  /// Its name in tables and figures.
  std::string label() const { return sim3 ? name + " (aligned by sim3)" : name; }
};

/// @param taken  Names that it can't have.
/// @return kBadInput: no NAME=POSES, a word other than sim3 behind @, a name that is taken or there twice.
Result<std::vector<ComparedSystem>> parse_compared(const std::vector<std::string>& texts,
                                                   const std::vector<std::string>& taken);

/// Its file for a sequence; "" where it has none.
std::string compared_file(const ComparedSystem& system, const std::string& sequence);

/// Looks at everything that can be wrong with them before any work.
/// @return kBadInput: one file for several drives, nothing for any of the drives, a file that can't be read, has other
/// than KITTI rows, or fewer than the drive has frames.
Result<void> check_compared(const std::vector<ComparedSystem>& systems, const std::vector<DriveChoice>& drives);

/// Its rows of a drive, as many as the truth has, aligned by sim3 where it is so.
struct ComparedPath {
  Trajectory path;
  int rows_in_file = 0;  ///< The first rows of these; the others lie beyond the drive.
};
/// @return kBadInput as check_compared; errors of align_points.
Result<ComparedPath> read_compared(const ComparedSystem& system, const std::string& sequence, const Trajectory& truth);

/// The trajectory under the similarity that brings its positions nearest to the truth's (Umeyama 1991).
/// @return errors of align_points. @pre as many rows.
Result<Trajectory> aligned_by_sim3(const Trajectory& estimate, const Trajectory& truth);

}  // namespace groundscale
