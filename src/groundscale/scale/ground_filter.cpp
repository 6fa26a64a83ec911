#include "groundscale/scale/ground_filter.hpp"

#include <cmath>

#include "groundscale/camera/mounting.hpp"
#include "groundscale/scale/filters_internal.hpp"

namespace groundscale {

template <>
std::vector<std::string_view> names_of<FilterKind>() {
  return {"paper", "model", "paper_scale"};
}

void visit_fields(GroundFilterOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "filter",
                 .unit = "",
                 .help = "paper: (n_x, n_z, h) at constant speed; paper_scale: h alone; model: mounting, deviation, "
                         "speed"},
                options.kind);
  visitor.field({.key = "acceleration_mps2",
                 .unit = "m/s^2",
                 .help = "sd of the change of speed, a second",
                 .min = 0.1,
                 .max = 20},
                options.acceleration_mps2);
  visitor.field({.key = "mean_drift_deg",
                 .unit = "deg/sqrt(s)",
                 .help = "random walk of the mounting's pitch and roll",
                 .min = 0,
                 .max = 5},
                options.mean_drift_deg);
  visitor.field({.key = "deviation_deg",
                 .unit = "deg",
                 .help = "sd of pitch and roll about their mean (suspension, slope)",
                 .min = 0.01,
                 .max = 10},
                options.deviation_deg);
  visitor.field(
      {.key = "deviation_time_s", .unit = "s", .help = "correlation time of the deviation", .min = 0.01, .max = 60},
      options.deviation_time_s);
  visitor.field({.key = "formal_variance_factor",
                 .unit = "",
                 .help = "how much the formal covariance is too small",
                 .min = 1,
                 .max = 1000},
                options.formal_variance_factor);
  visitor.field({.key = "angle_model_deg",
                 .unit = "deg",
                 .help = "sd of pitch and roll since roads aren't planes",
                 .min = 0,
                 .max = 10},
                options.angle_model_deg);
  visitor.field(
      {.key = "step_model", .unit = "", .help = "sd of log step since roads aren't planes", .min = 0.001, .max = 1},
      options.step_model);
}

GroundObservation observation_of(const GroundPlane& plane, const Eigen::Matrix3d& covariance_of_m,
                                 double camera_height_m) {
  const Eigen::Vector3d m = plane.inverse_form();
  const PlaneAngles angles = plane_angles(plane.normal_in_cam);
  GroundObservation observation;
  observation.pitch_rad = angles.pitch_rad;
  observation.roll_rad = angles.roll_rad;
  observation.log_distance = std::log(camera_height_m * m.norm());
  // pitch = atan2(m_z, m_y), roll = asin(m_x / |m|), log |m|.
  const double yz = m.y() * m.y() + m.z() * m.z();
  const double squared = m.squaredNorm();
  Eigen::Matrix3d by_m;
  by_m.row(0) << 0.0, -m.z() / yz, m.y() / yz;
  by_m.row(1) << std::sqrt(yz) / squared, -m.x() * m.y() / (squared * std::sqrt(yz)),
      -m.x() * m.z() / (squared * std::sqrt(yz));
  by_m.row(2) = m.transpose() / squared;
  observation.covariance = by_m * covariance_of_m * by_m.transpose();
  return observation;
}

std::unique_ptr<GroundFilter> make_ground_filter(const GroundFilterOptions& options, double camera_height_m) {
  if (options.kind == FilterKind::kModel) return make_model_filter(options);
  return make_paper_filter(options, camera_height_m);
}

}  // namespace groundscale
