#pragma once

#include <map>
#include <vector>

#include "groundscale/core/options.hpp"
#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/mapping/drive_tracks.hpp"

namespace groundscale {

struct DriveRecorderOptions {
  double view_px = 5.0;     ///< Median motion of the shared tracks after which a frame becomes the next view,
  double view_share = 0.6;  ///< or share of the view's tracks that are left.
};

void visit_fields(DriveRecorderOptions& options, FieldVisitor& visitor);

/// Keeps the tracks of a drive at frames that see something new. Memory: 24 bytes a sight.
class DriveRecorder {
 public:
  explicit DriveRecorder(const DriveRecorderOptions& options) : options_(options) {}

  /// A frame that moved, and its tracks, ids ascending.
  /// @param index  Its place among the drive's poses, ascending.
  void add(int index, int frame, const std::vector<TrackPoint>& tracks);

  /// What was kept. @param world_from_cam  Poses of the whole drive.
  DriveTracks drive(const std::vector<RigidTransform>& world_from_cam) const;

 private:
  DriveRecorderOptions options_;
  std::vector<TrackPoint> last_;
  std::vector<int> indices_, frames_;
  std::map<TrackId, std::vector<DriveTracks::Sight>> tracks_;
};

}  // namespace groundscale
