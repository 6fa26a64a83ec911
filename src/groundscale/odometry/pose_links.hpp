#pragma once

#include <map>
#include <span>
#include <vector>

#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/mapping/local_map.hpp"
#include "groundscale/odometry/frame_result.hpp"
#include "groundscale/scale/map_scale_filter.hpp"

namespace groundscale {

/// Pose of a frame by an earlier one: reference_from_cam, its translation in units of `unit_m` metres.
struct PoseLink {
  int reference = -1;  ///< Index of the earlier frame; -1 for the first.
  RigidTransform reference_from_cam;
  double unit_m = 1.0;
  bool by_map = false;  ///< Else by the pairwise odometry, in metres.
  bool is_keyframe = false;
  RigidTransform as_tracked = {};  ///< Of a keyframe: what the link was when it was added.
};

/// Enters a link into its frame's result.
void enter_link(const PoseLink& link, FrameResult& result);

/// Poses of a drive in the keyframe odometry: frames hang on keyframes, keyframes on the one before. So a keyframe that
/// an adjustment has moved is one link, and a scale found later one number.
class PoseLinks {
 public:
  void add(const PoseLink& link) { links_.push_back(link); }
  PoseLink& latest() { return links_.back(); }
  const PoseLink& latest() const { return links_.back(); }
  PoseLink& operator[](int frame) { return links_[static_cast<std::size_t>(frame)]; }
  const PoseLink& operator[](int frame) const { return links_[static_cast<std::size_t>(frame)]; }

  /// A map begins with a keyframe that lies there, in metres.
  void begin_map(const Keyframe& first, const RigidTransform& world_from_cam_m);
  /// Links of the map's keyframes become what they are in the map, and their poses in metres follow.
  void place_keyframes(const LocalMap& map);
  /// world_from_cam in metres of the latest frame, which hangs on a keyframe of the map; as of `place_keyframes`.
  RigidTransform latest_pose_m(const LocalMap& map) const;

  /// world_from_cam in metres of all frames. A frame between two keyframes follows what became of the way from one to
  /// the other after it was tracked: the similarity of that way as it was to as it is, turned by the share of the way
  /// that the frame has made.
  /// @param smoothed  Log metres per unit of the map in each frame; empty: unit_m of the links holds.
  std::vector<RigidTransform> poses_m(std::span<const MapScaleFilter::Smoothed> smoothed) const;

 private:
  RigidTransform final_link(const PoseLink& link, int next) const;

  std::vector<PoseLink> links_;
  std::map<int, RigidTransform> keyframes_m_;  ///< world_from_cam in metres, by serial.
};

}  // namespace groundscale
