#pragma once

#include <deque>
#include <vector>

#include "groundscale/camera/camera.hpp"
#include "groundscale/motion/two_view.hpp"
#include "groundscale/odometry/options.hpp"
#include "groundscale/road/road_matcher.hpp"
#include "groundscale/tracking/matches.hpp"

namespace groundscale {

/// An earlier frame that later ones may be paired with.
struct View {
  int result = 0;  ///< Index into the results.
  double time_s = 0.0;
  std::vector<TrackPoint> points;
  RoadView road;
  Image road_mask;  ///< Of this image: 0 where a detector saw no road; empty: no detector.
};

/// How a frame's camera moved since an earlier frame's.
struct PairMotion {
  int partner = 0;            ///< Index of the earlier frame's result.
  std::vector<RayPair> rays;  ///< Matches over the whole image.
  TwoViewMotion motion;
};

/// A frame and the earlier one that it is measured against.
struct Pair : PairMotion {
  View* view = nullptr;  ///< The earlier one.
  Matches matches;
};

/// The latest views, and the choice of a partner among them.
class Views {
 public:
  Views(const PairOptions& options, const MotionOptions& motion) : options_(options), motion_(motion) {}

  bool empty() const { return views_.empty(); }
  void push(View view);
  View& latest() { return views_.back(); }
  const View& latest() const { return views_.back(); }

  /// The latest view with `min_parallax_px` to the points; where none has so much, the one with most. The pair's motion
  /// says `still` where the points have not moved since the latest view.
  /// @param standing  Whether the camera stood in the frame before.
  Pair pair_with(const std::vector<TrackPoint>& points, const Camera& camera, bool standing = false);

 private:
  PairOptions options_;
  MotionOptions motion_;
  std::deque<View> views_;
};

}  // namespace groundscale
