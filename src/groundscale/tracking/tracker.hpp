#pragma once

#include <optional>
#include <vector>

#include "groundscale/core/options.hpp"
#include "groundscale/tracking/detect.hpp"
#include "groundscale/tracking/klt.hpp"
#include "groundscale/tracking/matches.hpp"
#include "groundscale/tracking/pyramid.hpp"

namespace groundscale {

struct TrackingOptions {
  int max_tracks = 500;
  /// Patches stretch as they come near, which large windows take for motion: 16 px doubled the rotation's error.
  KltOptions klt{.window_px = 11};
  DetectOptions detect{.cell_px = 24, .min_gradient = 2.0, .reduction = 2, .border_px = 8};
};

void visit_fields(TrackingOptions& options, FieldVisitor& visitor);

/// Points followed from frame to frame over the whole image, each under an id of its own that no other point ever has.
class Tracker {
 public:
  explicit Tracker(const TrackingOptions& options) : options_(options) {}

  /// Follows the tracks into the next frame and starts new ones where they have thinned out.
  /// @param mask  Where points are wanted (not 0); empty: everywhere.
  void advance(const Pyramid& next, const Image& mask);

  /// Puts points back under the ids that they had before they were lost, at pixels of the present frame; those whose id
  /// is still followed are left as they are.
  void revive(const std::vector<TrackPoint>& points);

  /// All tracks of the present frame, ids ascending.
  const std::vector<TrackPoint>& points() const { return points_; }
  /// How many of them were followed here from the frame before.
  int followed() const { return followed_; }

 private:
  void follow(const Pyramid& next, const Image& mask);
  std::vector<std::optional<Eigen::Vector2d>> track(const Pyramid& next) const;
  void replenish(const Pyramid& frame, const Image& mask);

  TrackingOptions options_;
  Pyramid last_;
  std::vector<TrackPoint> points_;
  std::vector<std::optional<Eigen::Vector2d>> steps_;  ///< Of each point into the present frame; nothing for new ones.
  int followed_ = 0;
  TrackId next_id_ = 0;
};

}  // namespace groundscale
