#pragma once

#include <vector>

#include "groundscale/core/image.hpp"
#include "groundscale/road/road_features.hpp"
#include "groundscale/road/road_tracker.hpp"
#include "groundscale/tracking/matches.hpp"

namespace groundscale {

/// Road points of one image, under ids of their own.
struct RoadView {
  Image image;
  std::vector<TrackPoint> points{};  ///< Ids ascending.
  RoadFeatures features{};           ///< Of the filled region, where the front end goes by them.
};

/// Road points with lasting ids: those that came from earlier images stay, and the region is filled up with new ones.
/// They are followed by image alignment (`track_on_road`) or by features (`match_on_road`).
class RoadMatcher {
 public:
  explicit RoadMatcher(const RoadTrackingOptions& options)
      : options_(options), by_features_(options.front_end == FrontEndKind::kStereoScan) {}

  /// Leaves out the points beyond the region and detects new ones where it is empty.
  void fill(RoadView& view, const Image& region);

  /// Follows some of the points of `first` into `second` through a warp that may be off by some pixels: enough to find
  /// a better one.
  Matches match_roughly(const RoadView& first, const Image& second, const RoadWarp& warp, const Camera& camera) const;
  /// Follows all of them; `fine` where the warp is right to about a pixel.
  Matches match(const RoadView& first, const Image& second, const RoadWarp& warp, bool fine,
                const Camera& camera) const;

 private:
  std::vector<Eigen::Vector2d> new_places(RoadView& view, const Image& region) const;

  RoadTrackingOptions options_;
  bool by_features_;
  TrackId next_id_ = 0;
};

}  // namespace groundscale
