#include "groundscale/road/trail.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace groundscale {
namespace {

Eigen::Vector3d on_plane(const Eigen::Vector3d& vector, const Eigen::Vector3d& normal) {
  return vector - normal * normal.dot(vector);
}

double distance_to_segment(const Eigen::Vector3d& point, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d along = to - from;
  const double length_squared = along.squaredNorm();
  const double share = length_squared > 0.0 ? std::clamp((point - from).dot(along) / length_squared, 0.0, 1.0) : 0.0;
  return (point - from - share * along).norm();
}

/// Of a point from the polyline of the trail's last `length_m`, all of them on the plane through the camera.
double distance_to_trail(const Eigen::Vector3d& point, const Trail& trail, const Eigen::Vector3d& normal,
                         double length_m) {
  double distance = std::numeric_limits<double>::infinity();
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  double left_m = length_m;
  for (const RigidTransform& cam_from_past : trail.cam_from_past) {
    const Eigen::Vector3d to = on_plane(cam_from_past.translation, normal);
    const double step_m = (to - from).norm();
    const double share = step_m > left_m ? left_m / step_m : 1.0;
    distance = std::min(distance, distance_to_segment(point, from, from + share * (to - from)));
    left_m -= step_m;
    if (left_m <= 0.0) break;
    from = to;
  }
  return distance;
}

}  // namespace

std::vector<Eigen::Vector3d> Trail::centres(double spacing_m, double length_m) const {
  std::vector<Eigen::Vector3d> result;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  double driven_m = 0.0;
  for (const RigidTransform& past : cam_from_past) {
    const Eigen::Vector3d& centre = past.translation;
    const double step_m = (centre - last).norm();
    if (step_m < spacing_m) continue;
    driven_m += step_m;
    if (driven_m > length_m) break;
    result.push_back(centre);
    last = centre;
  }
  return result;
}

Trail trail_of(const std::vector<RigidTransform>& world_from_cam, double metres_per_unit, double length_m) {
  Trail trail;
  if (world_from_cam.empty()) return trail;
  const RigidTransform cam_from_world = world_from_cam.back().inverse();
  double driven_m = 0.0;
  for (std::size_t k = world_from_cam.size() - 1; k-- > 0 && driven_m < length_m;) {
    RigidTransform past = cam_from_world * world_from_cam[k];
    past.translation *= metres_per_unit;
    driven_m += metres_per_unit * (world_from_cam[k + 1].translation - world_from_cam[k].translation).norm();
    trail.cam_from_past.push_back(past);
  }
  return trail;
}

void visit_fields(PathAheadOptions& options, FieldVisitor& visitor) {
  visitor.field(
      {.key = "heading_m", .unit = "m", .help = "way behind that the path ahead is taken from", .min = 0.2, .max = 50},
      options.heading_m);
  visitor.field({.key = "steady_m",
                 .unit = "m",
                 .help = "within such a way drivers change the curvature by as much as itself; 0: never",
                 .min = 0,
                 .max = 1000},
                options.steady_m);
  visitor.field({.key = "max_turn_deg",
                 .unit = "deg",
                 .help = "the path turns by so much, and goes straight on from there",
                 .min = 5,
                 .max = 180},
                options.max_turn_deg);
}

DrivenPath path_of_trail(const Trail& trail, const PathAheadOptions& options, const Eigen::Vector3d& normal_in_cam,
                         const Eigen::Vector3d& mounting_forward_in_cam) {
  RigidTransform past;
  for (const RigidTransform& cam_from_past : trail.cam_from_past) {
    past = cam_from_past;
    if (past.translation.norm() >= options.heading_m) break;
  }
  DrivenPath path = path_of_motion(past.inverse(), normal_in_cam, mounting_forward_in_cam, options.max_turn_deg);
  path.steady_m = options.steady_m;
  return path;
}

void visit_fields(PathWeightOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "behind_m", .unit = "m", .help = "points driven over count up to here", .min = 0, .max = 30},
                options.behind_m);
  visitor.field({.key = "ahead_m", .unit = "m", .help = "points ahead count up to here", .min = 3, .max = 100},
                options.ahead_m);
  visitor.field({.key = "half_width_m", .unit = "m", .help = "and up to here beside the path", .min = 0.3, .max = 10},
                options.half_width_m);
  visitor.field({.key = "weight_sd_m",
                 .unit = "m",
                 .help = "points count less the farther they lie from the path",
                 .min = 0.1,
                 .max = 100},
                options.weight_sd_m);
}

double path_weight(const Eigen::Vector3d& point_in_cam_m, const Trail& trail, const DrivenPath& path,
                   const GroundPlane& metric_road, const PathWeightOptions& options) {
  const Eigen::Vector3d& normal = metric_road.normal_in_cam;
  const Eigen::Vector3d point = on_plane(point_in_cam_m, normal);
  const double ahead = point.dot(path.forward_in_cam);
  double offset = 0.0;
  double sd = options.weight_sd_m;
  if (ahead >= 0.0) {
    if (point.norm() > options.ahead_m) return 0.0;
    // The same point on the road, whatever its own height.
    offset = std::abs(offset_from_path(path, metric_road, point + normal * metric_road.height));
    sd = std::hypot(sd, path.sd_m(point.norm()));
  } else {
    offset = distance_to_trail(point, trail, normal, options.behind_m);
  }
  const double share = options.weight_sd_m / sd;
  if (!(share * offset <= options.half_width_m)) return 0.0;
  return share * std::exp(-0.5 * std::pow(offset / sd, 2));
}

}  // namespace groundscale
