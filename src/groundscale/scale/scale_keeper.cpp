#include "groundscale/scale/scale_keeper.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "groundscale/core/check.hpp"
#include "groundscale/estimation/robust.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/scale/angle_internal.hpp"

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace

template <>
std::vector<std::string_view> names_of<ScaleCorrection>() {
  return {"none", "triggered", "filtered", "continuous"};
}

void visit_fields(ScaleKeeperOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "trigger", .unit = "", .help = "drift that is corrected", .min = 0.005, .max = 1},
                options.trigger);
  visitor.field({.key = "sustained",
                 .unit = "",
                 .help = "measurements in a row, correlation_m apart in the mean, that must speak for a correction",
                 .min = 1,
                 .max = 100},
                options.sustained);
  visitor.field({.key = "max_trigger_sd", .unit = "", .help = "sd of each of them", .min = 0.001, .max = 1},
                options.max_trigger_sd);
  visitor.field({.key = "max_trigger_turn_dps",
                 .unit = "deg/s",
                 .help = "no correction while turning faster",
                 .min = 0,
                 .max = 360},
                options.max_trigger_turn_dps);
  visitor.field({.key = "settle_m",
                 .unit = "m",
                 .help = "way over which a new map's scale is measured before it is held",
                 .min = 0,
                 .max = 1000},
                options.settle_m);
  visitor.field(
      {.key = "mounting_deg", .unit = "deg", .help = "normal against the expected one", .min = 0.5, .max = 45},
      options.mounting_deg);
  visitor.field({.key = "min_speed_mps", .unit = "m/s", .help = "slower measurements are refused", .min = 0, .max = 20},
                options.min_speed_mps);
  visitor.field({.key = "max_sd", .unit = "", .help = "sd of log scale of a measurement", .min = 0.001, .max = 1},
                options.max_sd);
  visitor.field({.key = "step_model", .unit = "", .help = "sd of log scale that roads add", .min = 0, .max = 1},
                options.step_model);
  visitor.field({.key = "formal_factor", .unit = "", .help = "of the formal sd", .min = 0, .max = 100},
                options.formal_factor);
  visitor.field({.key = "turn_model",
                 .unit = "",
                 .help = "sd of log scale for each 10 deg/s of turning beyond the first 10",
                 .min = 0,
                 .max = 1},
                options.turn_model);
  visitor.field({.key = "seen_share",
                 .unit = "",
                 .help = "of the turning since a road point was seen, by how much its scale is behind",
                 .min = 0,
                 .max = 1},
                options.seen_share);
  visitor.field({.key = "correlation_m",
                 .unit = "m",
                 .help = "measurements over a shorter way count as one together",
                 .min = 0,
                 .max = 100},
                options.correlation_m);
  visitor.field({.key = "tie_m", .unit = "m", .help = "way behind that is tied to the plane", .min = 0, .max = 100},
                options.tie_m);
  visit_fields(options.speed, visitor);
  visitor.group("ahead", options.ahead);
  visitor.group("path", options.path);
  visitor.group("plane", options.plane);
  visitor.group("filter", options.filter);
}

void ScaleKeeper::start(double metres_per_unit, double sd, int frames) {
  GS_CHECK(metres_per_unit > 0.0, "a scale is positive");
  filter_.start(std::log(metres_per_unit), sd);
  filter_.keep_again(frames);
  held_ = metres_per_unit;
  driven_m_ = 0.0;
  since_measured_m_ = options_.correlation_m;
  last_time_s_.reset();
  sustained_.clear();
}

double ScaleKeeper::held() const { return follows_ground() ? std::exp(filter_.log_scale()) : held_; }

ScaleKeeper::Motion ScaleKeeper::motion_of(const Input& input) const {
  const std::vector<RigidTransform>& poses = input.world_from_cam;
  Motion motion;
  if (poses.size() >= 2) {
    const RigidTransform& before = poses[poses.size() - 2];
    motion.units = (poses.back().translation - before.translation).norm();
    motion.distance_m = held() * motion.units;
    motion.turn_rad = rotation_angle(poses.back().rotation.transpose() * before.rotation);
  }
  const double dt_s = last_time_s_ ? input.time_s - *last_time_s_ : 0.0;
  if (dt_s > 0.0) {
    motion.speed_mps = motion.distance_m / dt_s;
    motion.turn_rate_dps = motion.turn_rad / kDegree / dt_s;
  }
  if (input.turn_rate_dps) motion.turn_rate_dps = std::abs(*input.turn_rate_dps);
  return motion;
}

ScaleReport ScaleKeeper::advance(const Input& input) {
  GS_CHECK(!input.world_from_cam.empty(), "at least the present pose");
  const Motion motion = motion_of(input);
  last_time_s_ = input.time_s;
  driven_m_ += motion.distance_m;
  since_measured_m_ += motion.distance_m;
  filter_.predict(motion.distance_m, motion.turn_rad);

  ScaleReport report;
  measure(input, motion, report);
  if (report.measured) judge(input, motion, report);
  if (report.reason.empty()) {
    // Neighbouring frames see the same stretch of road: what they say together is worth no more than one of them.
    const double share = std::clamp(since_measured_m_ / std::max(1e-6, options_.correlation_m), 1e-3, 1.0);
    filter_.update(std::log(*report.measured), report.measured_sd / std::sqrt(share), report.turned_rad);
    since_measured_m_ = 0.0;
  } else {
    report.by_log = take_logged(input, motion);
  }
  // A new map's scale is measured over its first metres, and then held.
  if (driven_m_ <= options_.settle_m) held_ = std::exp(filter_.log_scale());
  report.held = held();
  report.held_sd = filter_.sd();
  if (report.measured) report.drift_ratio = *report.measured / report.held;
  if (correction_ == ScaleCorrection::kTriggered && report.reason.empty()) decide(motion, report);
  filter_.keep();
  return report;
}

void ScaleKeeper::pass(double time_s, double distance_m) {
  last_time_s_ = time_s;
  driven_m_ += distance_m;
  since_measured_m_ += distance_m;
  filter_.predict(distance_m, 0.0);
  filter_.keep();
}

void ScaleKeeper::skip() {
  filter_.start(std::log(held()), options_.filter.start_sd);
  filter_.keep();
  last_time_s_.reset();
}

/// The road points beside the path, weighed, and the camera's own way.
/// @param which  The points' indices in the input.
PlanePoints ScaleKeeper::points_on_path(const Input& input, std::vector<int>& which) const {
  const double unit_m = held();
  const RigidTransform cam_from_world = input.world_from_cam.back().inverse();
  const GroundPlane road{input.expected_normal, camera_height_m_};
  const Trail trail = trail_of(input.world_from_cam, unit_m, std::max(options_.tie_m, options_.path.behind_m) + 1.0);
  const DrivenPath path = path_of_trail(trail, options_.ahead, input.expected_normal, input.mounting.forward_in_cam());
  PlanePoints points;
  points.metres_per_unit = unit_m;
  points.expected_normal = input.expected_normal;
  points.forward_in_cam = path.forward_in_cam;
  for (std::size_t i = 0; i < input.road_points_in_world.size(); ++i) {
    const Eigen::Vector3d in_cam = cam_from_world * input.road_points_in_world[i];
    const double weight = path_weight(unit_m * in_cam, trail, path, road, options_.path);
    if (!(weight > 0.0)) continue;
    points.points_in_cam.push_back(in_cam);
    points.weights.push_back(weight);
    which.push_back(static_cast<int>(i));
  }
  constexpr double kSpacingM = 0.8;
  for (const Eigen::Vector3d& centre : trail.centres(kSpacingM, options_.tie_m)) {
    points.centres_in_cam.emplace_back(centre / unit_m);
  }
  return points;
}

void ScaleKeeper::measure(const Input& input, const Motion& motion, ScaleReport& report) const {
  std::vector<int> which;
  const PlanePoints points = points_on_path(input, which);
  report.points_on_path = static_cast<int>(which.size());
  const auto plane = fit_point_plane(points, options_.plane);
  if (!plane) {
    report.reason = plane.error().message;
    return;
  }
  report.measured = camera_height_m_ / plane->plane.height;
  report.plane_in_cam = plane->plane;
  const double turn = options_.turn_model * std::max(0.0, motion.turn_rate_dps / 10.0 - 1.0);
  report.measured_sd = std::sqrt(std::pow(options_.step_model, 2) +
                                 std::pow(options_.formal_factor * plane->log_height_sd, 2) + turn * turn);
  double weights = 0.0;
  for (const int i : plane->inliers) {
    const auto point = static_cast<std::size_t>(which[static_cast<std::size_t>(i)]);
    report.inliers.push_back(which[static_cast<std::size_t>(i)]);
    if (input.turned_since_seen_rad.empty()) continue;
    const double weight = points.weights[static_cast<std::size_t>(i)];
    report.turned_rad += weight * input.turned_since_seen_rad[point];
    weights += weight;
  }
  if (weights > 0.0) report.turned_rad *= options_.seen_share / weights;
}

void ScaleKeeper::judge(const Input& input, const Motion& motion, ScaleReport& report) const {
  const double angle = angle_deg(report.plane_in_cam.normal_in_cam, input.expected_normal);
  if (angle > options_.mounting_deg) {
    report.reason = fmt::format("normal is {:.1f} deg off the expected one", angle);
  } else if (!(motion.speed_mps >= options_.min_speed_mps)) {
    report.reason = fmt::format("speed {:.2f} m/s is too low", motion.speed_mps);
  } else if (!(report.measured_sd <= options_.max_sd)) {
    report.reason = fmt::format("sd of {:.1f} % is too large", 100.0 * report.measured_sd);
  }
}

/// What a log says in place of the ground. A scale that is held is none of its business.
bool ScaleKeeper::take_logged(const Input& input, const Motion& motion) {
  if (!input.logged_step || !(motion.units > 0.0)) return false;
  if (!follows_ground() && driven_m_ > options_.settle_m) return false;
  const double log_scale = std::log(input.logged_step->distance_m / motion.units);
  if (is_gross(log_scale - filter_.log_scale(), filter_.sd(), *input.logged_step)) return false;
  filter_.update(log_scale, input.logged_step->log_sd);
  return true;
}

/// Whether this frame's measurement, which counts, completes a row of them that speak for a correction. Those that are
/// too uncertain, or made in a turn, neither continue the row nor end it.
void ScaleKeeper::decide(const Motion& motion, ScaleReport& report) {
  if (driven_m_ <= options_.settle_m || report.measured_sd > options_.max_trigger_sd ||
      motion.turn_rate_dps > options_.max_trigger_turn_dps) {
    return;
  }
  const double log_ratio = std::log(*report.drift_ratio);
  if (!(std::abs(*report.drift_ratio - 1.0) > options_.trigger)) {
    sustained_.clear();
    return;
  }
  if (!sustained_.empty() && (sustained_.back() > 0.0) != (log_ratio > 0.0)) sustained_.clear();
  if (sustained_.empty()) sustained_from_m_ = driven_m_;
  sustained_.push_back(log_ratio);
  // Whatever the frame rate: neighbouring frames say the same.
  const double least_m = (options_.sustained - 1) * options_.correlation_m;
  if (static_cast<int>(sustained_.size()) < options_.sustained || driven_m_ - sustained_from_m_ < least_m) return;
  report.correction = std::exp(median(sustained_));
  sustained_.clear();
}

void ScaleKeeper::corrected(double lambda) {
  GS_CHECK(lambda > 0.0, "a scale is positive");
  // The same stretch of road has lambda times as many units now, and each of them is so many metres fewer.
  filter_.change_unit(-std::log(lambda));
  sustained_.clear();
}

Similarity scaling_about(const Eigen::Vector3d& centre, double lambda) {
  return {lambda, Eigen::Matrix3d::Identity(), (1.0 - lambda) * centre};
}

}  // namespace groundscale
