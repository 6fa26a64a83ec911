#pragma once

#include <optional>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/image.hpp"
#include "groundscale/road/road_network.hpp"
#include "groundscale/road/road_tracker.hpp"

namespace groundscale {

/// A mask of view 1 as view 2 has it: pixel x2 takes the value at x1 = project(H21^-1 ray(x2)), with the road's
/// homography H21 = R + t m^T below the horizon and with R alone above it, where things are far.
///
/// What view 1 didn't see (beside its image, or nearer than its lower edge) is allowed, 255: a mask forbids what a
/// detector has looked at, and where nobody has looked it is as if there were no detector.
/// @param mask_in_1  Of the camera's size, 0 or 255.
Image carry_mask(const Image& mask_in_1, const RoadWarp& warp, const Camera& camera);

/// Masks of the road for the frames of a drive: by the network for every n-th of them, by the motion for those between.
///
/// Deterministic. Only what stands on the road is carried wrongly, for n - 1 frames: other vehicles as if they were
/// painted on it.
class RoadDetector {
 public:
  /// @return kBadInput as RoadNetwork::open.
  static Result<RoadDetector> open(const RoadNetworkOptions& options, CameraPtr camera);

  /// Mask of the next frame, 255 road, 0 not.
  /// @param frame  Of the camera's size.
  /// @param frame_from_last  Motion from the last frame that was given to this one, and the road in the last one; empty
  ///                         where it isn't known: the network is run.
  Image advance(const Image& frame, const std::optional<RoadWarp>& frame_from_last);

  /// How often the network was run, and the time it took in all.
  int runs() const { return runs_; }
  double network_s() const { return network_s_; }

 private:
  RoadDetector(RoadNetwork network, int every, CameraPtr camera);

  RoadNetwork network_;
  int every_;
  CameraPtr camera_;
  Image mask_;       ///< Of the last frame.
  int carried_ = 0;  ///< Frames since the last run.
  int runs_ = 0;
  double network_s_ = 0.0;
};

}  // namespace groundscale
