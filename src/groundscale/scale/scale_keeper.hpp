#pragma once

#include <optional>
#include <string>
#include <vector>

#include "groundscale/camera/mounting.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/geometry/ground_plane.hpp"
#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/geometry/similarity.hpp"
#include "groundscale/plane/point_plane.hpp"
#include "groundscale/road/trail.hpp"
#include "groundscale/scale/map_scale_filter.hpp"
#include "groundscale/scale/speed_reference.hpp"

namespace groundscale {

/// How a map's scale is held (docs/method.md).
enum class ScaleCorrection {
  kNone,        ///< The scale found at the start is held.
  kTriggered,   ///< The same, and the map is scaled where it has drifted by more than a threshold (Algorithm 2).
  kFiltered,    ///< Metres per map unit follow the ground as a slow process.
  kContinuous,  ///< The ground takes part in the bundle adjustment, and what is left is filtered.
};

struct ScaleKeeperOptions {
  double trigger = 0.075;              ///< |lambda - 1| above which the map is scaled.
  int sustained = 5;                   ///< Measurements in a row that have to say so, correlation_m apart in the mean.
  double max_trigger_sd = 0.02;        ///< Sd of log scale of each of them,
  double max_trigger_turn_dps = 10.0;  ///< and the turn rate up to which they count.
  double settle_m = 15.0;              ///< Way over which the scale of a new map is measured before it is held.
  double mounting_deg = 5.0;   ///< Angle between normal and expected normal above which a measurement is refused.
  double min_speed_mps = 0.5;  ///< Slower measurements are refused.
  double max_sd = 0.1;         ///< Measured sd of log scale above which a measurement is refused.
  double step_model = 0.01;    ///< Sd of log scale that roads add, not being planes,
  double formal_factor = 4.0;  ///< beside so many times the formal sd,
  double turn_model = 0.005;   ///< and for each 10 deg/s of turning beyond the first 10.
  /// Of the turning since a point was seen, how much its scale is behind by: the local map goes on adjusting it.
  double seen_share = 0.5;
  double correlation_m = 1.0;    ///< Measurements over a shorter way than this count as one together.
  double tie_m = 8.0;            ///< Way behind the camera that is tied to the plane.
  PathAheadOptions ahead;        ///< Where the vehicle is going.
  PathWeightOptions path;        ///< Which road points count.
  PointPlaneOptions plane;       ///< How the plane is laid through them.
  MapScaleFilterOptions filter;  ///< How the scale moves.
  SpeedReferenceOptions speed;   ///< The log that stands in for the ground; the odometry reads it, the keeper doesn't.
};

template <>
std::vector<std::string_view> names_of<ScaleCorrection>();
void visit_fields(ScaleKeeperOptions& options, FieldVisitor& visitor);

/// What a frame's ground says about the scale of a map.
struct ScaleReport {
  std::string reason;   ///< Why the measurement is refused; empty where it counts.
  bool by_log = false;  ///< Refused, and the step that a speed log gives was observed in its place.
  std::optional<double>
      measured;              ///< Metres per map unit by this frame's plane; set where there is one, refused or not.
  double measured_sd = 0.0;  ///< Sd of its log, with what roads and turns add to the formal one.
  GroundPlane plane_in_cam;  ///< Where measured, in map units.
  std::vector<int> inliers;  ///< Indices of the road points given that lie on the plane, ascending.
  int points_on_path = 0;    ///< Road points that had weight.
  double turned_rad = 0.0;   ///< By how much the camera has turned since the scale was the measured one.
  double held = 1.0;         ///< Metres per map unit in force after this frame.
  double held_sd = 0.0;      ///< Sd of the filter's log scale (not of a scale that was held since long ago).
  std::optional<double> drift_ratio;  ///< lambda = measured / held, where measured; > 1: the map has become too small.
  /// Set (`triggered` alone) where the map should be scaled, by this lambda: then scale it and call `corrected`.
  std::optional<double> correction;
};

/// Keeps the scale of somebody's map by the road: Algorithm 2 of Zhou, Dai, Li 2019, and what measures better.
///
/// With h the height of the camera over its road in map units (fit_point_plane) and H_c that in metres,
///   measured = H_c / h   and   lambda = measured / held,   both held and measured in metres per map unit.
/// The measurement's variance is step_model^2 + (formal_factor sd)^2 + (turn_model max(0, rate / 10 deg/s - 1))^2; over
/// a step d shorter than correlation_m it counts with d / correlation_m of that weight. `none`, `triggered`: held is
/// the filter's scale over a map's first settle_m, and then stays. `filtered`,
/// `continuous`: held is the filter's scale. Where the ground says nothing, or is refused, a speed log may: over a step
///   measured = logged distance in metres / step in map units,
/// observed with the sd that comes with it unless is_gross; it moves the filter alone, so a scale that is held stays,
/// and never speaks for a correction. Deterministic. O(road points + poses) a frame; memory grows by 150 bytes a frame.
class ScaleKeeper {
 public:
  /// @param camera_height_m  Over the road, perpendicular to it; > 0.
  ScaleKeeper(double camera_height_m, ScaleCorrection correction, const ScaleKeeperOptions& options)
      : camera_height_m_(camera_height_m), correction_(correction), options_(options), filter_(options.filter) {}

  /// A map begins, whose unit is metres_per_unit (> 0) up to the sd of its log. Before the first one it is 1.
  /// @param frames  So many of the latest frames (advance, pass, skip) belong to it already.
  void start(double metres_per_unit, double sd, int frames = 0);

  /// A frame of the map. Poses and points are in the map's unit, and both as they are now, after its last adjustment.
  struct Input {
    double time_s = 0.0;  ///< Later than that of the frame before.
    /// Latest poses of the map: the present one last, before it that of the frame before, and so on, a pose for each
    /// frame; back to 1 m beyond tie_m and path.behind_m. More does no harm, less says less.
    std::vector<RigidTransform> world_from_cam;
    /// Points that are taken for road: from path.behind_m behind to path.ahead_m ahead, others are passed over.
    std::vector<Eigen::Vector3d> road_points_in_world;
    /// For each road point by how much the camera has turned since it was seen, rad; empty where that isn't known.
    std::vector<double> turned_since_seen_rad = {};
    /// Of the camera on the vehicle; says where ahead is until there is a trail that does.
    Mounting mounting;
    /// Unit normal of the road in the present camera as known so far, from the camera down: the mounting's, or its
    /// running mean. Prior of the plane, and what mounting_deg is measured from.
    Eigen::Vector3d expected_normal = Eigen::Vector3d::UnitY();
    /// How fast the camera turns, left or right; empty: by the last two poses and times.
    std::optional<double> turn_rate_dps;
    /// What a speed log says of the way between the last two poses; empty where there is none, or it isn't trusted.
    std::optional<LoggedStep> logged_step = std::nullopt;
  };
  /// Measures, and updates what is held. A frame that can't be measured has a reason in its report, and the scale goes
  /// on.
  ScaleReport advance(const Input& input);

  /// The correction was made: the part of the map that is in use, its poses and points, is now lambda times as large.
  void corrected(double lambda);
  /// A frame of the map without a measurement: standing, or without an image.
  /// @param distance_m  Driven since the frame before.
  void pass(double time_s, double distance_m);
  /// A frame without a map (bridged): the scale's history has a gap.
  void skip();

  /// Metres per map unit in force.
  double held() const;
  /// Whether that follows the ground from frame to frame: `filtered` and `continuous`.
  bool follows_ground() const {
    return correction_ == ScaleCorrection::kFiltered || correction_ == ScaleCorrection::kContinuous;
  }
  double held_sd() const { return filter_.sd(); }  ///< As ScaleReport::held_sd.
  /// log(metres per unit) from the whole drive: one for each advance, pass and skip, each in the unit that its map had
  /// then.
  std::vector<MapScaleFilter::Smoothed> smoothed() const { return filter_.smoothed(); }

 private:
  /// How the camera has moved since the frame before.
  struct Motion {
    double units = 0.0, distance_m = 0.0, turn_rad = 0.0;
    double speed_mps = 0.0, turn_rate_dps = 0.0;
  };
  Motion motion_of(const Input& input) const;
  PlanePoints points_on_path(const Input& input, std::vector<int>& which) const;
  void measure(const Input& input, const Motion& motion, ScaleReport& report) const;
  void judge(const Input& input, const Motion& motion, ScaleReport& report) const;
  bool take_logged(const Input& input, const Motion& motion);
  void decide(const Motion& motion, ScaleReport& report);

  double camera_height_m_;
  ScaleCorrection correction_;
  ScaleKeeperOptions options_;
  MapScaleFilter filter_;
  double driven_m_ = 0.0;  ///< With this map.
  double since_measured_m_ = 0.0;
  double held_ = 1.0;
  std::optional<double> last_time_s_;
  std::vector<double> sustained_;  ///< log lambda of the last measurements that speak for a correction,
  double sustained_from_m_ = 0.0;  ///< the first of them there.
};

/// X -> c + lambda (X - c): what scales a local map, its points and camera centres, about the centre c of its oldest
/// keyframe. Rotations stay.
Similarity scaling_about(const Eigen::Vector3d& centre, double lambda);

}  // namespace groundscale
