#pragma once

#include <memory>
#include <vector>

#include "groundscale/camera/mounting.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/core/stage_clock.hpp"
#include "groundscale/geometry/trajectory.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/sequence.hpp"
#include "groundscale/motion/two_view.hpp"
#include "groundscale/odometry/frame_result.hpp"
#include "groundscale/odometry/options.hpp"
#include "groundscale/road/region.hpp"
#include "groundscale/road/road_detector.hpp"
#include "groundscale/scale/speed_reference.hpp"

namespace groundscale {

/// What a frame was measured from, for pictures and figures.
struct FrameDetails {
  Image reference_image;  ///< Of the partner, in which the region lies.
  Image region;
  std::vector<RayPair> pairs;  ///< Whole image.
  Matches matches;             ///< The same in pixels.
  std::vector<int> inliers;
  Matches road_matches;
  std::vector<int> road_inliers;
  GroundPlane road;  ///< Metres, in the partner's camera.
  DrivenPath path;
  RigidTransform cam_from_reference;  ///< Metres.
};

/// What has come of a drive so far: a link and a step for each frame, and the poses made of them.
class DriveOutcome {
 public:
  virtual ~DriveOutcome() = default;

  virtual const std::vector<FrameResult>& results() const = 0;
  /// Whether scale is known; before, online poses are in a provisional unit.
  virtual bool scaled() const = 0;
  /// Poses from frames up to each one's own, in metres once `scaled`.
  virtual const std::vector<RigidTransform>& online_poses() const = 0;
  /// Poses from the whole drive, once that has ended.
  virtual std::vector<RigidTransform> final_poses() const = 0;
  /// Mounting as found so far.
  virtual Mounting mounting() const = 0;
  /// Scalings of the map so far.
  virtual std::vector<ScaleEvent> corrections() const { return {}; }
  /// Changes of the camera so far.
  virtual std::vector<CameraEvent> camera_changes() const { return {}; }
  /// The road network; null where the options name none.
  virtual const RoadDetector* road_detector() const { return nullptr; }
  /// The speed log that stands in for the ground; null where the options name none.
  virtual const SpeedReference* speed_reference() const { return nullptr; }
};

/// Images in, metric poses out. Deterministic for given images, camera and options.
class Odometry : public DriveOutcome {
 public:
  /// Takes the next frame.
  /// @param road_mask  Of this frame's size: 0 where a detector saw no road; empty: no detector.
  virtual const FrameResult& advance(const Frame& frame, const Image& road_mask) = 0;
  const FrameResult& advance(const Frame& frame) { return advance(frame, Image()); }

  /// After the last frame: steps from the whole drive.
  virtual void finish() = 0;

  /// Of the latest frame; put together when it is asked for.
  virtual FrameDetails details() const = 0;
  /// Tracks over the whole image in the latest frame, ids ascending; valid until the next one.
  virtual const std::vector<TrackPoint>& tracks() const = 0;
  /// Time that each stage has taken so far.
  virtual const StageClock& clock() const = 0;
};

/// The odometry that options.mode names.
/// @param setup  Its height_m must be set. Pitch and roll that it leaves out are found in the first seconds.
/// @return kBadInput where no road is in view with the camera so mounted, options are out of range, or a file that they
///         name can't be used.
Result<std::unique_ptr<Odometry>> make_odometry(const CameraSetup& setup, const OdometryOptions& options);

}  // namespace groundscale
