#pragma once

#include <deque>
#include <vector>

#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/mapping/local_map.hpp"

namespace groundscale {

/// The latest frames in the map's world, in its unit: where they were tracked, and where they go with the keyframes
/// that they hang on. Says where the next frame is to be expected and which way the vehicle has come.
class MapTrail {
 public:
  struct Frame {
    int index = 0;
    double time_s = 0.0;
    RigidTransform cam_from_world;
    int keyframe = -1;  ///< Serial of the keyframe that it hangs on; -1 where the map hasn't placed it.
    RigidTransform cam_from_keyframe = {};
  };

  void clear() { frames_.clear(); }
  const std::deque<Frame>& frames() const { return frames_; }
  const Frame& latest() const { return frames_.back(); }

  /// A frame before the map.
  void add(int index, double time_s, const RigidTransform& cam_from_world);
  /// A frame of the map. @return cam_from_keyframe.
  const RigidTransform& add(int index, double time_s, const RigidTransform& cam_from_world, const Keyframe& keyframe);
  /// The latest frame has become that keyframe.
  void hang_latest_on_itself(int serial);
  /// The camera still stands where the latest frame saw it.
  void stand(double time_s) { frames_.back().time_s = time_s; }

  /// Constant velocity, turn and translation apart; after a long time no farther than 20 of the last steps.
  RigidTransform predicted_pose(double time_s) const;
  /// Of a frame between the latest one and a later one: an even share of the motion, turn and translation apart.
  RigidTransform pose_between(const RigidTransform& later_cam_from_world, double later_s, double time_s) const;
  /// before_from_cam of the latest frame; there must be two.
  RigidTransform latest_step() const { return (frames_.end() - 2)->cam_from_world * latest().cam_from_world.inverse(); }
  std::vector<RigidTransform> world_from_cam() const;

  /// Frames go where the keyframes of the map have gone.
  void follow(const LocalMap& map);
  /// What lies between frames and their keyframes grows with the map; their own poses follow with `follow`.
  void scale(double lambda);
  void forget_after(int index);   ///< All but the oldest.
  void forget_before(int index);  ///< All but the latest two.
  /// Frames farther from the latest one than that; all but the latest three.
  void forget_behind(double distance_m, double unit_m);

 private:
  std::deque<Frame> frames_;
};

}  // namespace groundscale
