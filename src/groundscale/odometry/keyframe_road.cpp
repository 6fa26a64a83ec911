// The road's part of the keyframe odometry: followed through the map's prediction, measured from the map's points.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <Eigen/Geometry>

#include "groundscale/geometry/so3.hpp"
#include "groundscale/odometry/keyframe.hpp"

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace

GroundPlane KeyframeOdometry::expected_road(const RigidTransform& cam_from_world) const {
  const Eigen::Vector3d normal = road_normal_in_world_
                                     ? Eigen::Vector3d(cam_from_world.rotation * *road_normal_in_world_)
                                     : mounting_.mean_normal();
  return {normal, camera_height_m_};
}

/// Follows the road's points through what the map says that camera and road have done.
bool KeyframeOdometry::follow_road(const TrackedFrame& present) {
  const MapTrail::Frame& here = trail_.latest();
  const auto& frames = trail_.frames();
  const auto view = std::find_if(frames.begin(), frames.end(),
                                 [this](const MapTrail::Frame& frame) { return frame.index == road_.view_frame(); });
  if (view == frames.end()) return true;
  const GroundPlane road = expected_road(here.cam_from_world);
  RoadWarp warp;
  warp.cam2_from_cam1 = here.cam_from_world * view->cam_from_world.inverse();
  warp.cam2_from_cam1.translation *= keeper_.held();
  warp.road_in_cam1 = {warp.cam2_from_cam1.rotation.transpose() * road.normal_in_cam, road.height};
  details_.road_matches = road_.follow(present.frame.image, present.index, warp);
  details_.reference_image = road_.view().image;
  details_.cam_from_reference = warp.cam2_from_cam1;
  details_.road = warp.road_in_cam1;
  clock_.lap("road tracking");
  constexpr double kMinBaseline = 0.2;  // of the camera's height
  return warp.cam2_from_cam1.translation.norm() > kMinBaseline * camera_height_m_;
}

/// The strip along the path, where it isn't the vehicle's own and detectors see road.
Image KeyframeOdometry::road_region(const TrackedFrame& present, const DrivenPath& path, const GroundPlane& road) {
  RegionOptions options = options_.keyframe.region;
  options.polygon_px = options_.road.region.polygon_px;
  const Image strip = region_mask(path, road, *camera_, options);
  Image allowed = intersect_masks(tracking_mask_, present.road_mask);
  if (detector_) {
    clock_.lap("road detection");
    std::optional<RoadWarp> warp;
    if (road_.view_frame() >= 0) warp = RoadWarp{details_.cam_from_reference, details_.road};
    allowed = intersect_masks(allowed, detector_->advance(present.frame.image, warp));
    clock_.lap("road network");
  }
  return restrict_region(strip, allowed);
}

void KeyframeOdometry::measure_road(FrameResult& result, const TrackedFrame& present, bool look) {
  const double unit_m = keeper_.held();
  const MapTrail::Frame& here = trail_.latest();
  const GroundPlane road = expected_road(here.cam_from_world);
  const std::vector<RigidTransform> poses = trail_.world_from_cam();
  const Trail trail = trail_of(poses, unit_m, options_.scale.tie_m + 1.0);
  DrivenPath path =
      path_of_trail(trail, options_.scale.ahead, road.normal_in_cam, mounting_.mounting().forward_in_cam());
  path.max_turn_rad = options_.road.region.max_turn_deg * kDegree;
  if (look) {
    details_.region = road_region(present, path, road);
    road_.look(present.frame.image, present.index, details_.region);
  }
  details_.path = path;
  clock_.lap("road detection");

  const auto& frames = trail_.frames();
  std::vector<RigidTransform> cam_from_world;
  for (const MapTrail::Frame& frame : frames) {
    while (!cam_from_world.empty() && frames.front().index + static_cast<int>(cam_from_world.size()) < frame.index) {
      cam_from_world.push_back(cam_from_world.back());  // of a frame that stood
    }
    cam_from_world.push_back(frame.cam_from_world);
  }
  const std::vector<RoadTracks::Point> points = road_.points(cam_from_world, frames.front().index);
  ScaleKeeper::Input input;
  input.time_s = present.frame.time_s;
  input.world_from_cam = poses;
  // By how much the camera has turned since each frame of the trail.
  std::vector<double> turned(cam_from_world.size(), 0.0);
  for (std::size_t k = turned.size(); k-- > 1;) {
    turned[k - 1] = turned[k] + rotation_angle(cam_from_world[k].rotation * cam_from_world[k - 1].rotation.transpose());
  }
  for (const RoadTracks::Point& point : points) {
    input.road_points_in_world.push_back(point.point_in_world);
    input.turned_since_seen_rad.push_back(
        turned[static_cast<std::size_t>(std::max(0, point.mean_frame - frames.front().index))]);
  }
  input.mounting = mounting_.mounting();
  input.expected_normal = mounting_.mean_normal();
  if (frames.size() >= 2) {
    const MapTrail::Frame& before = frames[frames.size() - 2];
    const double turn = log_so3(here.cam_from_world.rotation * before.cam_from_world.rotation.transpose()).norm();
    input.turn_rate_dps = turn / kDegree / std::max(1e-3, here.time_s - before.time_s);
  }
  clock_.lap("road points");
  const ScaleReport report = keeper_.advance(input);
  hold_by_ground(report);
  std::set<TrackId> on_plane;
  for (const int i : report.inliers) on_plane.insert(points[static_cast<std::size_t>(i)].id);
  for (std::size_t i = 0; i < details_.road_matches.size(); ++i) {
    if (on_plane.contains(details_.road_matches[i].id)) details_.road_inliers.push_back(static_cast<int>(i));
  }
  take_report(result, report, path.curvature_per_m);
  clock_.lap("scale");

  // What lies too far behind for the plane is forgotten.
  constexpr double kKeptM = 25.0;
  trail_.forget_behind(kKeptM, unit_m);
  road_.forget_before(trail_.frames().front().index);
}

/// Continuous correction: the ground's metres of the latest step between keyframes for the next adjustment. The map's
/// unit is to be a metre.
void KeyframeOdometry::hold_by_ground(const ScaleReport& report) {
  const auto& keyframes = map_.keyframes();
  if (options_.odometry.scale_correction != ScaleCorrection::kContinuous || !report.reason.empty()) return;
  if (keyframes.back().frame != trail_.latest().index || keyframes.size() < 2) return;
  const RigidTransform step =
      keyframes[keyframes.size() - 2].cam_from_world * keyframes.back().cam_from_world.inverse();
  const double distance_m = *report.measured * step.translation.norm();
  if (distance_m > 0.0) map_.set_distance(distance_m, report.measured_sd / options_.keyframe.ground_weight);
}

void KeyframeOdometry::take_report(FrameResult& result, const ScaleReport& report, double curvature_per_m) {
  result.reason = report.reason;
  result.road_matches = report.points_on_path;
  result.road_inliers = static_cast<int>(report.inliers.size());
  result.map_scale = report.held;
  result.online_step_sd = report.held_sd;
  if (!report.measured) return;
  result.raw_over_online = *report.measured / report.held;
  result.drift_ratio = report.drift_ratio;
  last_drift_ratio_ = *report.drift_ratio;
  if (correction_open_ && report.reason.empty()) {
    corrections_.back().drift_after = *report.drift_ratio;
    correction_open_ = false;
  }
  result.raw_sd = report.measured_sd;
  const PlaneAngles angles = plane_angles(report.plane_in_cam.normal_in_cam);
  result.pitch_rad = angles.pitch_rad;
  result.roll_rad = angles.roll_rad;
  if (report.correction) pending_correction_ = report.correction;
  if (!report.reason.empty()) return;
  mounting_.accept(angles.pitch_rad, angles.roll_rad, mounting_weight(curvature_per_m, report.measured_sd));
  // A poor fit must not lead the tracking of the road's points.
  constexpr int kMinInliers = 40;
  constexpr double kMaxSd = 0.03;
  if (result.road_inliers >= kMinInliers && report.measured_sd <= kMaxSd) {
    road_normal_in_world_ = trail_.latest().cam_from_world.rotation.transpose() * report.plane_in_cam.normal_in_cam;
  }
}

}  // namespace groundscale
