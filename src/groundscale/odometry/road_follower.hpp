#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "groundscale/core/stage_clock.hpp"
#include "groundscale/mapping/road_tracks.hpp"
#include "groundscale/odometry/bridge.hpp"
#include "groundscale/odometry/map_trail.hpp"
#include "groundscale/odometry/mounting_estimate.hpp"
#include "groundscale/scale/scale_keeper.hpp"

namespace groundscale {

/// The road under a map: its points are followed from frame to frame through what the map says that camera and road
/// have done, and placed by the trail of frames that saw them. What the scale keeper finds by them says where the road
/// is to be expected next.
///
/// A frame's calls: follow, look, observe, accept. Frames are those of the trail, the present one its latest; `unit_m`
/// are metres per unit of the map.
class RoadFollower {
 public:
  /// @param pairwise  Whose road network and mounting it goes on with.
  RoadFollower(const CameraSetup& setup, const OdometryOptions& options, const PairwiseOdometry& pairwise);

  /// A map begins; the mounting is as known by now.
  void begin(const MountingEstimate& mounting);
  /// The map is lost, and with it the points.
  void lose() { road_.clear(); }

  /// The camera is another one from now on, in the same axes.
  void use_camera(const CameraPtr& camera) {
    camera_ = camera;
    road_.use_camera(camera);
  }

  /// Follows the points from the frame that was last looked at into the present one.
  void follow(const TrackedFrame& present, const MapTrail& trail, double unit_m);
  /// Finds new points in the present frame along the path ahead, where the last one with new points lies far enough
  /// behind.
  void look(const TrackedFrame& present, const MapTrail& trail, double unit_m, StageClock& clock);
  /// What the scale is measured from.
  ScaleKeeper::Input observe(const MapTrail& trail);
  /// Takes what was measured from it, which is refused or not.
  void accept(const ScaleReport& report, const MapTrail& trail);
  /// Points last seen before that frame are forgotten.
  void forget_before(int index) { road_.forget_before(index); }

  /// Points of the present frame that were followed into it.
  const Matches& matches() const { return matches_; }
  /// Their transfer error |pixel2 - project(H ray1)| by the plane that was measured, rms of those that lie on it; 0
  /// where none do.
  double rms_px() const { return rms_px_; }
  /// Fills what concerns the road.
  void describe(FrameDetails& details) const;

  const MountingEstimate& mounting() const { return mounting_; }
  const RoadDetector* detector() const { return detector_.get(); }

 private:
  double transfer_rms_px(const GroundPlane& road_in_cam, const MapTrail& trail) const;
  GroundPlane expected_road(const RigidTransform& cam_from_world) const;
  Image road_region(const TrackedFrame& present, const DrivenPath& path, const GroundPlane& road, StageClock& clock);

  CameraPtr camera_;
  double camera_height_m_;
  OdometryOptions options_;
  Image tracking_mask_;
  std::shared_ptr<RoadDetector> detector_;
  MountingEstimate mounting_;
  RoadTracks road_;
  std::optional<Eigen::Vector3d> road_normal_in_world_;

  // Of the present frame:
  Matches matches_;
  std::vector<int> inliers_;        ///< Of the matches.
  Image reference_image_, region_;  ///< That the matches come from; where new points were looked for.
  std::optional<RoadWarp> warp_;    ///< From the reference, in metres; empty where no points were followed.
  int reference_ = -1;              ///< Index of the frame that the matches come from.
  double rms_px_ = 0.0;
  bool due_ = true;  ///< Whether it's time for new points.
  DrivenPath path_;
  std::vector<RoadTracks::Point> points_;
};

}  // namespace groundscale
