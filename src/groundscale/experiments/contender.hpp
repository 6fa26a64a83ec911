#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/evaluation/kitti_errors.hpp"
#include "groundscale/experiments/compared_system.hpp"
#include "groundscale/experiments/measured_run.hpp"
#include "groundscale/geometry/trajectory.hpp"

namespace groundscale {

/// Estimated over true length of a piece of the way.
struct PieceRatio {
  double distance_m = 0.0;  ///< Of its middle, along the truth.
  double ratio = 1.0;
};

/// What is measured the same way on every trajectory of a drive.
struct PathMeasures {
  Trajectory path;  ///< Begins at the identity; one aligned by sim3 lies in the world of the truth's first camera.
  std::vector<KittiErrors::OfLength> by_length;  ///< Over the drive's segment_lengths_m.
  std::optional<SegmentErrors> over_50m;
  std::vector<PieceRatio> pieces;
};

/// A trajectory beside the truth: of one of our modes, or of another system.
struct Contender {
  std::string label;
  std::map<std::string, std::optional<double>>
      figures;  ///< By the names of docs/evaluation.md, and t_rel_50m, r_rel_50m.
  PathMeasures measures;
  std::optional<MeasuredRun> run;  ///< Ours.
  std::string remark;              ///< What its label doesn't say.

  std::optional<double> figure(const std::string& name) const;
};

/// Lengths of segments that errors are shown over: from 50 m on a path below 1 km, else KITTI's.
std::vector<double> segment_lengths_m(double path_m);

/// Measures an estimate against the truth. @param first_from_world  Where it is drawn. @return as kitti_errors.
Result<PathMeasures> measure_path(const Trajectory& estimate, const Trajectory& truth,
                                  const RigidTransform& first_from_world);

/// Ours. @param truth  The drive's over the frames run. @return kIo where its results can't be read.
Result<Contender> contend_with(const std::string& label, MeasuredRun run, const Trajectory& truth);
/// Another system's on a drive that it has a file for. @return as read_compared and evaluate.
Result<Contender> contend_with(const ComparedSystem& system, const std::string& sequence, const Trajectory& truth);

}  // namespace groundscale
