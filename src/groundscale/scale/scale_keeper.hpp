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

namespace groundscale {

/// How a map's scale is held (docs/method.md).
enum class ScaleCorrection {
  kNone,        ///< The scale found at the start is held.
  kTriggered,   ///< The same, and the map is scaled where it has drifted by more than a threshold (Algorithm 2).
  kFiltered,    ///< Metres per map unit follow the ground as a slow process.
  kContinuous,  ///< The ground takes part in the bundle adjustment, and what is left is filtered.
};

struct ScaleKeeperOptions {
  double trigger = 0.075;         ///< |lambda - 1| above which the map is scaled.
  int sustained = 5;              ///< Measurements in a row that have to say so.
  double max_trigger_sd = 0.02;   ///< Of each of them.
  double max_trigger_turn_dps = 10.0;
  double settle_m = 15.0;         ///< Way over which the scale of a new map is measured before it is held.
  double mounting_deg = 5.0;      ///< Normal against the expected one.
  double min_speed_mps = 0.5;
  double max_sd = 0.1;            ///< Of log scale, enlarged: beyond, a measurement is refused.
  double step_model = 0.01;       ///< Sd of log scale that roads add, not being planes,
  double formal_factor = 4.0;     ///< beside so much of the formal sd,
  double turn_model = 0.005;      ///< and for each 10 deg/s of turning beyond the first 10.
  double correlation_m = 1.0;     ///< Measurements of a shorter way than this count as one together.
  double tie_m = 8.0;             ///< Way behind the camera that is tied to the plane.
  double heading_m = 3.0;         ///< Way behind the camera that the path ahead is taken from.
  PathWeightOptions path;
  PointPlaneOptions plane;
  MapScaleFilterOptions filter;
};

template <>
std::vector<std::string_view> names_of<ScaleCorrection>();
void visit_fields(ScaleKeeperOptions& options, FieldVisitor& visitor);

/// What a frame's ground says about the scale of a map.
struct ScaleReport {
  std::string reason;              ///< Why the measurement is refused; empty where it counts.
  std::optional<double> measured;  ///< Metres per map unit by this frame's ground.
  double measured_sd = 0.0;        ///< Of its log.
  GroundPlane plane_in_cam;        ///< Where measured, in map units.
  std::vector<int> inliers;        ///< Of the road points given.
  int points_on_path = 0;
  double held = 1.0;     ///< Metres per map unit in force.
  double held_sd = 0.0;  ///< Of its log.
  double drift_ratio = 1.0;  ///< lambda = measured / held, > 1: the map has become too small; 1 where not measured.
  /// Set where the map should be scaled (triggered): by lambda.
  std::optional<double> correction;
};

/// Keeps the scale of somebody's map by the road: Algorithm 2 of Zhou, Dai, Li 2019 and what measures better.
///
/// Each frame: where the camera has been and the road points of the map, in the map's unit. lambda = measured / held,
/// measured = camera_height_m / h with h the height of the road's plane in map units. Deterministic.
class ScaleKeeper {
 public:
  ScaleKeeper(double camera_height_m, ScaleCorrection correction, const ScaleKeeperOptions& options)
      : camera_height_m_(camera_height_m), correction_(correction), options_(options), filter_(options.filter) {}

  /// A map begins, whose unit is metres_per_unit up to the sd of its log.
  void start(double metres_per_unit, double sd);

  struct Input {
    double time_s = 0.0;
    /// Latest poses of the map, the present one last; as far back as 15 m.
    std::vector<RigidTransform> world_from_cam;
    std::vector<Eigen::Vector3d> road_points_in_world;
    Mounting mounting;                 ///< As known so far.
    Eigen::Vector3d expected_normal = Eigen::Vector3d::UnitY();  ///< Of the road in the present camera.
    double turn_rate_dps = 0.0;
  };
  ScaleReport advance(const Input& input);

  /// The correction was made: the part of the map that is in use is now lambda times as large.
  void corrected(double lambda);
  /// A frame of the map without a measurement: standing, or without an image.
  void pass(double time_s, double distance_m);
  /// A frame without a map (bridged): the scale's history has a gap.
  void skip();

  double held() const;
  /// Whether the scale in force follows the ground from frame to frame.
  bool follows_ground() const {
    return correction_ == ScaleCorrection::kFiltered || correction_ == ScaleCorrection::kContinuous;
  }
  double held_sd() const { return filter_.sd(); }
  /// log(metres per unit) of every frame since the first, from the whole drive.
  std::vector<MapScaleFilter::Smoothed> smoothed() const { return filter_.smoothed(); }

 private:
  void measure(const Input& input, const Trail& trail, ScaleReport& report) const;
  void judge(const Input& input, double speed_mps, ScaleReport& report) const;
  void decide(const Input& input, ScaleReport& report);

  double camera_height_m_;
  ScaleCorrection correction_;
  ScaleKeeperOptions options_;
  MapScaleFilter filter_;
  double driven_m_ = 0.0;  ///< With this map.
  double since_measured_m_ = 0.0;
  double held_ = 1.0;
  std::optional<double> last_time_s_;
  std::vector<double> sustained_;  ///< log lambda of the last measurements that speak for a correction.
};

/// X -> c0 + lambda (X - c0): what scales a local map about the centre of its oldest keyframe.
Similarity scaling_about(const Eigen::Vector3d& centre, double lambda);

}  // namespace groundscale
