#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/road/road_matcher.hpp"

namespace groundscale {

struct RoadTracksOptions {
  double min_parallax_px = 4.0;  ///< Largest angle between a point's rays, in pixels at the image's centre.
  double max_error_px = 1.0;     ///< Rms reprojection error above which a point is left out.
  int max_sights = 8;            ///< That a point is computed from, spread evenly over its views.
};

void visit_fields(RoadTracksOptions& options, FieldVisitor& visitor);

/// Points of the road followed from image to image through the warp that the map predicts, and where they lie.
///
/// One image is the view: its points are followed into each later frame (`follow`), until a frame that has gone far
/// enough becomes the view in its place (`look`). Every frame in which a point was found is a sight of it.
/// Deterministic. Memory grows with the points that are not forgotten, 100 bytes a sight.
class RoadTracks {
 public:
  RoadTracks(CameraPtr camera, const RoadTrackingOptions& tracking, const RoadTracksOptions& options)
      : camera_(std::move(camera)), matcher_(tracking), options_(options) {}

  /// Forgets all points and the view.
  void clear();
  /// The camera is another one from now on, in the same axes: what was seen gets its rays anew.
  void use_camera(CameraPtr camera);
  /// The image that later ones are followed from; empty before the first `look`.
  const RoadView& view() const { return view_; }
  int view_frame() const { return view_frame_; }  ///< -1 without one.

  /// Follows the view's points into a frame's image (RoadMatcher::match).
  /// @param frame  Later than all before.
  /// @return The matches, from the view; valid until the next call of anything here.
  const Matches& follow(const Image& image, int frame, const RoadWarp& frame_from_view);
  /// The frame becomes the view: the points that were followed into it stay, the region is filled up with new ones.
  /// @param region  255 where road may be; points beyond it end.
  void look(const Image& image, int frame, const Image& region);
  /// Points last seen before that frame are forgotten.
  void forget_before(int frame);

  struct Point {
    std::int64_t id = 0;
    Eigen::Vector3d point_in_world = Eigen::Vector3d::Zero();
    int mean_frame = 0;  ///< In the middle of those that saw it.
  };
  /// Where the points lie (`triangulate`), by the poses of the frames that saw them. Points with fewer than three
  /// sights, too little parallax or too large an error are left out. Ids ascending. O(points max_sights^2).
  /// @param cam_from_world  Of frames first_frame, first_frame + 1, ...; sights of other frames don't count.
  std::vector<Point> points(const std::vector<RigidTransform>& cam_from_world, int first_frame) const;

 private:
  struct Track {
    struct Sight {
      int frame = 0;
      Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
      Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();
    };
    std::vector<Sight> sights;
  };
  void add_sight(TrackId id, int frame, const Eigen::Vector2d& pixel);

  CameraPtr camera_;
  RoadMatcher matcher_;
  RoadTracksOptions options_;
  RoadView view_;
  int view_frame_ = -1;
  Matches matches_;
  int matches_frame_ = -1;  ///< That they lead to.
  std::map<TrackId, Track> tracks_;
};

}  // namespace groundscale
