#pragma once

#include <deque>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/mapping/bundle_adjustment.hpp"
#include "groundscale/tracking/matches.hpp"

namespace groundscale {

struct LocalMapOptions {
  int free_keyframes = 6;        ///< Adjusted by the bundle adjustment;
  int fixed_keyframes = 3;       ///< so many before them hold it.
  int max_points = 800;          ///< Landmarks in the adjustment, those with most sights.
  double min_parallax_px = 3.0;  ///< Between the rays of a new landmark.
  double max_error_px = 1.5;     ///< A sight that is farther off after the adjustment is left out.
  int strikes = 3;  ///< Frames in a row in which a landmark may disagree with the map before it is dropped.
  BundleOptions bundle{.loss = BundleLoss::kCauchy, .loss_px = 0.5};
};

void visit_fields(LocalMapOptions& options, FieldVisitor& visitor);

struct Keyframe {
  int serial = 0;  ///< Counts up by one.
  int frame = 0;   ///< Index of the frame's result.
  RigidTransform cam_from_world;
  std::vector<TrackPoint> points;  ///< Ids ascending.
  /// Distance to the keyframe before that the ground asks for, in the map's unit, and the sd of its log.
  std::optional<double> distance = std::nullopt;
  double distance_log_sd = 0.0;
};

/// A point followed over several keyframes.
struct Landmark {
  struct Sight {
    int keyframe = 0;  ///< Serial.
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();
  };
  std::vector<Sight> sights;  ///< Keyframes ascending.
  std::optional<Eigen::Vector3d> point_in_world;
  int strikes = 0;
  bool rejected = false;  ///< It moves, or is no point at all: never to be tried again.
};

/// The latest keyframes and what they see. Poses and points are in a unit of the map's own.
class LocalMap {
 public:
  LocalMap(CameraPtr camera, const LocalMapOptions& options) : camera_(std::move(camera)), options_(options) {}

  void clear();
  /// The camera is another one from now on, in the same axes: what was seen gets its rays anew; poses and points stay
  /// until the next adjustment.
  void use_camera(CameraPtr camera);
  bool empty() const { return keyframes_.empty(); }
  const std::deque<Keyframe>& keyframes() const { return keyframes_; }
  /// Null for one that has left the map.
  const Keyframe* find(int serial) const;
  /// Null where the track is no landmark.
  const Eigen::Vector3d* point_of(TrackId id) const;
  int point_count() const;

  /// Adds a keyframe and the sights of its tracks; the oldest one leaves a full map. @return its serial.
  int add(int frame, const RigidTransform& cam_from_world, const std::vector<TrackPoint>& points);
  /// Makes landmarks of the latest keyframe's tracks that have enough parallax by now. @return how many.
  int triangulate();
  /// Bundle adjustment of the latest keyframes, then sights that disagree are left out.
  void adjust();
  /// Whether each of these landmarks agreed with the present frame's pose; who disagrees too often moves.
  void judge(const std::vector<TrackId>& ids, const std::vector<bool>& agreed);

  /// What the ground says of the way from the keyframe before to the latest one; the adjustment takes it into account.
  void set_distance(double distance, double log_sd);

  /// Scales the local map, the last `free_keyframes` and all landmarks, by lambda about the centre of the oldest of
  /// them. Older keyframes see the same points at the old scale: their sights are left out from now on.
  /// @return the keyframe that stayed where it is.
  const Keyframe& scale(double lambda);

 private:
  /// Keyframes from `begin` take part in the adjustment, those from `free` on are moved by it.
  struct Window {
    std::size_t begin = 0;
    std::size_t free = 1;
  };
  Window window() const;
  std::vector<Landmark*> landmarks_in(const Window& window);
  Bundle bundle_of(const Window& window, std::span<Landmark* const> landmarks) const;
  double scale_kept(const Window& window, const Bundle& bundle) const;
  void forget_old();
  void retriangulate(Landmark& landmark);
  void drop_bad_sights();

  CameraPtr camera_;
  LocalMapOptions options_;
  std::deque<Keyframe> keyframes_;
  std::map<TrackId, Landmark> landmarks_;
  int next_serial_ = 0;
  int boundary_ = 0;  ///< Serial of the oldest keyframe of the last correction; sights before it are gone.
};

}  // namespace groundscale
