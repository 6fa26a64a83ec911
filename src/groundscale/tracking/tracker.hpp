#pragma once

#include <memory>
#include <vector>

#include "groundscale/tracking/front_end.hpp"
#include "groundscale/tracking/matches.hpp"

namespace groundscale {

/// Points followed from frame to frame over the whole image, each under an id of its own that no other point ever has.
class Tracker {
 public:
  explicit Tracker(const TrackingOptions& options)
      : max_tracks_(options.max_tracks), front_end_(make_front_end(options)) {}
  Tracker(const Tracker& other);
  Tracker& operator=(const Tracker& other);
  Tracker(Tracker&&) = default;
  Tracker& operator=(Tracker&&) = default;
  ~Tracker() = default;

  /// Follows the tracks into the next frame and starts new ones where they have thinned out.
  /// @param mask  Where points are wanted (not 0); empty: everywhere.
  void advance(const Image& next, const Image& mask);

  /// Puts points back under the ids that they had before they were lost, at pixels of the present frame; those whose id
  /// is still followed are left as they are.
  void revive(const std::vector<TrackPoint>& points);

  /// All tracks of the present frame, ids ascending.
  const std::vector<TrackPoint>& points() const { return points_; }
  /// How many of them were followed here from the frame before.
  int followed() const { return followed_; }

 private:
  std::vector<Eigen::Vector2d> pixels() const;
  void follow(const Image& next, const Image& mask);
  void replenish(const Image& mask);

  int max_tracks_;
  std::unique_ptr<FrontEnd> front_end_;
  std::vector<TrackPoint> points_;
  FrontEnd::Places steps_;  ///< Of each point into the present frame; nothing for new ones.
  int followed_ = 0;
  TrackId next_id_ = 0;
};

}  // namespace groundscale
