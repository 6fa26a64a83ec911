#include "groundscale/scale/gates.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/scale/angle_internal.hpp"

namespace groundscale {
namespace {

std::string spread_refusal(const GateCandidate& candidate, const GateOptions& options) {
  std::vector<double> depths;
  std::vector<double> widths;
  const Eigen::Vector3d& normal = candidate.plane.normal_in_cam;
  const double height_m = candidate.plane.height * candidate.distance_m;
  for (const Eigen::Vector3d& ray : candidate.inlier_rays) {
    const Eigen::Vector3d point = ray * (height_m / normal.dot(ray));
    depths.push_back((point - normal * height_m).norm());
    widths.push_back(point.x());
  }
  const double ratio = quantile(depths, 0.95) / quantile(depths, 0.05);
  if (!(ratio >= options.min_depth_ratio))
    return fmt::format("inliers lie in one line across the road (depth ratio {:.2f})", ratio);
  const double width = quantile(widths, 0.95) - quantile(widths, 0.05);
  if (!(width >= options.min_width_m))
    return fmt::format("inliers lie in one line along the road ({:.2f} m wide)", width);
  return {};
}

std::string speed_refusal(const GateCandidate& candidate, const GateContext& context, const GateOptions& options) {
  const double speed = candidate.distance_m / context.pair_time_s;
  if (!(speed >= options.min_speed_mps)) return fmt::format("speed {:.2f} m/s is too low", speed);
  if (!context.filter_started) return {};
  // Change of the distance that the vehicle can make since the last frame, beside what isn't known of it.
  constexpr double kSigmas = 3.0;
  const double sd = std::hypot(context.expected_log_sd, candidate.log_sd);
  const double driven = options.max_acceleration_mps2 * context.step_time_s * context.pair_time_s;
  const double change = candidate.distance_m - context.expected_distance_m;
  // The sd is that of a logarithm: after a halt, when it is large, the step may be many times what was expected.
  const double share = change > 0.0 ? std::expm1(kSigmas * sd) : kSigmas * sd;
  if (std::abs(change) <= driven + share * context.expected_distance_m) return {};
  return fmt::format("step of {:.2f} m where {:.2f} m were expected", candidate.distance_m,
                     context.expected_distance_m);
}

}  // namespace

void visit_fields(GateOptions& options, FieldVisitor& visitor) {
  visitor.field(
      {.key = "mounting_deg", .unit = "deg", .help = "normal against the mounting normal", .min = 0.5, .max = 45},
      options.mounting_deg);
  visitor.field({.key = "unsettled_mounting_deg",
                 .unit = "deg",
                 .help = "the same until the mounting has been found",
                 .min = 0.5,
                 .max = 60},
                options.unsettled_mounting_deg);
  visitor.field({.key = "mean_deg",
                 .unit = "deg",
                 .help = "normal against the running mean of accepted ones",
                 .min = 0.2,
                 .max = 45},
                options.mean_deg);
  visitor.field({.key = "min_depth_ratio",
                 .unit = "",
                 .help = "distance of the farthest over the nearest inliers",
                 .min = 1,
                 .max = 10},
                options.min_depth_ratio);
  visitor.field(
      {.key = "min_width_m", .unit = "m", .help = "spread of the inliers across the road", .min = 0, .max = 10},
      options.min_width_m);
  visitor.field({.key = "min_speed_mps", .unit = "m/s", .help = "slower measurements are refused", .min = 0, .max = 20},
                options.min_speed_mps);
  visitor.field(
      {.key = "max_acceleration_mps2", .unit = "m/s^2", .help = "what the vehicle can do", .min = 0.5, .max = 50},
      options.max_acceleration_mps2);
  visitor.field({.key = "max_step_sd", .unit = "", .help = "largest sd of log step", .min = 0.005, .max = 1},
                options.max_step_sd);
}

std::string refusal(const GateCandidate& candidate, const GateContext& context, const GateOptions& options) {
  const double bound = context.mounting_settled ? options.mounting_deg : options.unsettled_mounting_deg;
  const double initial = angle_deg(candidate.initial_plane.normal_in_cam, context.mounting_normal);
  if (initial > bound) return fmt::format("initial normal is {:.1f} deg off the mounting", initial);
  const double refined = angle_deg(candidate.plane.normal_in_cam, context.mounting_normal);
  if (refined > bound) return fmt::format("normal is {:.1f} deg off the mounting", refined);
  if (context.mounting_settled) {
    const double off_mean = angle_deg(candidate.plane.normal_in_cam, context.mean_normal);
    if (off_mean > options.mean_deg) return fmt::format("normal is {:.1f} deg off the mean of the drive", off_mean);
  }
  if (!(candidate.log_sd <= options.max_step_sd))
    return fmt::format("step is uncertain by {:.1f} %", 100.0 * candidate.log_sd);
  const std::string spread = spread_refusal(candidate, options);
  return spread.empty() ? speed_refusal(candidate, context, options) : spread;
}

}  // namespace groundscale
