#include "groundscale/scale/scale_keeper.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "groundscale/core/check.hpp"
#include "groundscale/estimation/robust.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

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
                 .help = "measurements in a row that must speak for a correction",
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
  visitor.field({.key = "mounting_deg", .unit = "deg", .help = "normal against the expected one", .min = 0.5, .max = 45},
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
  visitor.field({.key = "correlation_m",
                 .unit = "m",
                 .help = "measurements over a shorter way count as one together",
                 .min = 0,
                 .max = 100},
                options.correlation_m);
  visitor.field({.key = "tie_m", .unit = "m", .help = "way behind that is tied to the plane", .min = 0, .max = 100},
                options.tie_m);
  visitor.field(
      {.key = "heading_m", .unit = "m", .help = "way behind that the path ahead is taken from", .min = 0.2, .max = 50},
      options.heading_m);
  visitor.group("path", options.path);
  visitor.group("plane", options.plane);
  visitor.group("filter", options.filter);
}

void ScaleKeeper::start(double metres_per_unit, double sd) {
  GS_CHECK(metres_per_unit > 0.0, "a scale is positive");
  filter_.start(std::log(metres_per_unit), sd);
  held_ = metres_per_unit;
  driven_m_ = 0.0;
  since_measured_m_ = options_.correlation_m;
  last_time_s_.reset();
  sustained_.clear();
}

double ScaleKeeper::held() const {
  return follows_ground() ? std::exp(filter_.log_scale()) : held_;
}

ScaleReport ScaleKeeper::advance(const Input& input) {
  const std::vector<RigidTransform>& poses = input.world_from_cam;
  GS_CHECK(!poses.empty(), "at least the present pose");
  const double step_m =
      poses.size() < 2 ? 0.0 : held() * (poses.back().translation - poses[poses.size() - 2].translation).norm();
  const double dt_s = last_time_s_ ? input.time_s - *last_time_s_ : 0.0;
  last_time_s_ = input.time_s;
  driven_m_ += step_m;
  since_measured_m_ += step_m;

  const double turn_rad = poses.size() < 2 ? 0.0 : rotation_angle(poses.back().rotation.transpose() * poses[poses.size() - 2].rotation);
  filter_.predict(step_m, turn_rad);
  ScaleReport report;
  const Trail trail = trail_of(poses, held(), std::max(options_.tie_m, options_.path.behind_m) + 1.0);
  measure(input, trail, report);
  if (report.measured) judge(input, dt_s > 0.0 ? step_m / dt_s : 0.0, report);
  if (report.reason.empty()) {
    // Neighbouring frames see the same stretch of road: what they say together is worth no more than one of them.
    const double share = std::clamp(since_measured_m_ / std::max(1e-6, options_.correlation_m), 1e-3, 1.0);
    filter_.update(std::log(*report.measured), report.measured_sd / std::sqrt(share));
    since_measured_m_ = 0.0;
  }
  // A new map's scale is measured over its first metres, and then held.
  if (driven_m_ <= options_.settle_m) held_ = std::exp(filter_.log_scale());
  report.held = held();
  report.held_sd = filter_.sd();
  if (report.measured) report.drift_ratio = *report.measured / report.held;
  if (correction_ == ScaleCorrection::kTriggered) decide(input, report);
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

void ScaleKeeper::measure(const Input& input, const Trail& trail, ScaleReport& report) const {
  const double unit_m = held();
  const RigidTransform cam_from_world = input.world_from_cam.back().inverse();
  const GroundPlane road{input.expected_normal, camera_height_m_};
  const DrivenPath path =
      path_of_trail(trail, options_.heading_m, input.expected_normal, input.mounting.forward_in_cam());
  PlanePoints points;
  points.metres_per_unit = unit_m;
  points.expected_normal = input.expected_normal;
  points.forward_in_cam = path.forward_in_cam;
  std::vector<int> which;
  for (std::size_t i = 0; i < input.road_points_in_world.size(); ++i) {
    const Eigen::Vector3d in_cam = cam_from_world * input.road_points_in_world[i];
    const double weight = path_weight(unit_m * in_cam, trail, path, road, options_.path);
    if (!(weight > 0.0)) continue;
    points.points_in_cam.push_back(in_cam);
    points.weights.push_back(weight);
    which.push_back(static_cast<int>(i));
  }
  report.points_on_path = static_cast<int>(which.size());
  for (const Eigen::Vector3d& centre : trail.centres(/*spacing_m=*/0.8, options_.tie_m)) {
    points.centres_in_cam.push_back(centre / unit_m);
  }
  const auto plane = fit_point_plane(points, options_.plane);
  if (!plane) {
    report.reason = plane.error().message;
    return;
  }
  report.measured = camera_height_m_ / plane->plane.height;
  report.plane_in_cam = plane->plane;
  const double turn = options_.turn_model * std::max(0.0, std::abs(input.turn_rate_dps) / 10.0 - 1.0);
  report.measured_sd = std::sqrt(std::pow(options_.step_model, 2) +
                                 std::pow(options_.formal_factor * plane->log_height_sd, 2) + turn * turn);
  for (const int i : plane->inliers) report.inliers.push_back(which[static_cast<std::size_t>(i)]);
}

void ScaleKeeper::judge(const Input& input, double speed_mps, ScaleReport& report) const {
  const double angle = angle_deg(report.plane_in_cam.normal_in_cam, input.expected_normal);
  if (angle > options_.mounting_deg) {
    report.reason = fmt::format("normal is {:.1f} deg off the expected one", angle);
  } else if (!(speed_mps >= options_.min_speed_mps)) {
    report.reason = fmt::format("speed {:.2f} m/s is too low", speed_mps);
  } else if (!(report.measured_sd <= options_.max_sd)) {
    report.reason = fmt::format("sd of {:.1f} % is too large", 100.0 * report.measured_sd);
  }
}

void ScaleKeeper::decide(const Input& input, ScaleReport& report) {
  if (!report.reason.empty() || driven_m_ <= options_.settle_m) return;
  const double ratio = report.drift_ratio;
  const bool sure = report.measured_sd <= options_.max_trigger_sd &&
                    std::abs(input.turn_rate_dps) <= options_.max_trigger_turn_dps;
  if (!sure) return;
  const double log_ratio = std::log(ratio);
  const bool same_side = sustained_.empty() || (sustained_.back() > 0.0) == (log_ratio > 0.0);
  if (!(std::abs(ratio - 1.0) > options_.trigger) || !same_side) {
    sustained_.clear();
    return;
  }
  sustained_.push_back(log_ratio);
  if (static_cast<int>(sustained_.size()) < options_.sustained) return;
  report.correction = std::exp(median(sustained_));
  sustained_.clear();
}

void ScaleKeeper::corrected(double lambda) {
  // The map has grown: a unit of it is as many metres again as it was at the start.
  filter_.start(filter_.log_scale() - std::log(lambda), filter_.sd());
  sustained_.clear();
}

Similarity scaling_about(const Eigen::Vector3d& centre, double lambda) {
  return {lambda, Eigen::Matrix3d::Identity(), (1.0 - lambda) * centre};
}

}  // namespace groundscale
