#pragma once

#include <map>
#include <vector>

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/road/road_matcher.hpp"

namespace groundscale {

struct RoadTracksOptions {
  double min_parallax_px = 4.0;  ///< Between the rays of a road point.
  double max_error_px = 1.0;     ///< Rms reprojection error of a road point.
  int max_sights = 8;            ///< Of a point, spread evenly over its views.
};

void visit_fields(RoadTracksOptions& options, FieldVisitor& visitor);

/// Points of the road followed from image to image through the warp that the map predicts, and where they lie.
class RoadTracks {
 public:
  RoadTracks(CameraPtr camera, const RoadTrackingOptions& tracking, const RoadTracksOptions& options)
      : camera_(std::move(camera)), matcher_(tracking), options_(options) {}

  void clear();
  /// The image that later ones are followed from; empty before the first `look`.
  const RoadView& view() const { return view_; }
  int view_frame() const { return view_frame_; }

  /// Follows the view's points into a frame's image.
  const Matches& follow(const Image& image, int frame, const RoadWarp& frame_from_view);
  /// The frame becomes the view: the points followed there stay, the region is filled up with new ones.
  void look(const Image& image, int frame, const Image& region);
  /// Points last seen before that frame are forgotten.
  void forget_before(int frame);

  struct Point {
    std::int64_t id = 0;
    Eigen::Vector3d point_in_world = Eigen::Vector3d::Zero();
    int mean_frame = 0;  ///< In the middle of those that saw it.
  };
  /// Where the points lie, by the poses of the frames that saw them. Ids ascending.
  /// @param cam_from_world  Of frames first_frame, first_frame + 1, ...; sights of earlier ones are left out.
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
  std::map<TrackId, Track> tracks_;
};

}  // namespace groundscale
