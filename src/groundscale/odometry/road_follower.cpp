#include "groundscale/odometry/road_follower.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <Eigen/Geometry>

#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace

RoadFollower::RoadFollower(const CameraSetup& setup, const OdometryOptions& options, const PairwiseOdometry& pairwise)
    : camera_(setup.camera),
      camera_height_m_(*setup.height_m),
      options_(options),
      tracking_mask_(allowed_of(setup.vehicle_mask)),
      detector_(pairwise.shared_detector()),
      mounting_(pairwise.mounting_estimate()),
      road_(setup.camera, options.road.tracking, options.keyframe.road) {}

void RoadFollower::begin(const MountingEstimate& mounting) {
  mounting_ = mounting;
  road_normal_in_world_.reset();
  road_.clear();
}

GroundPlane RoadFollower::expected_road(const RigidTransform& cam_from_world) const {
  const Eigen::Vector3d normal = road_normal_in_world_
                                     ? Eigen::Vector3d(cam_from_world.rotation * *road_normal_in_world_)
                                     : mounting_.mean_normal();
  return {normal, camera_height_m_};
}

void RoadFollower::follow(const TrackedFrame& present, const MapTrail& trail, double unit_m) {
  matches_.clear();
  inliers_.clear();
  rms_px_ = 0.0;
  reference_image_ = {};
  region_ = {};
  warp_.reset();
  due_ = true;
  const MapTrail::Frame& here = trail.latest();
  const auto& frames = trail.frames();
  const auto view = std::find_if(frames.begin(), frames.end(),
                                 [this](const MapTrail::Frame& frame) { return frame.index == road_.view_frame(); });
  if (view == frames.end()) return;
  const GroundPlane road = expected_road(here.cam_from_world);
  RoadWarp warp;
  warp.cam2_from_cam1 = here.cam_from_world * view->cam_from_world.inverse();
  warp.cam2_from_cam1.translation *= unit_m;
  warp.road_in_cam1 = {warp.cam2_from_cam1.rotation.transpose() * road.normal_in_cam, road.height};
  matches_ = road_.follow(present.frame.image, present.index, warp);
  reference_image_ = road_.view().image;
  reference_ = view->index;
  warp_ = warp;
  constexpr double kMinBaseline = 0.2;  // of the camera's height
  due_ = warp.cam2_from_cam1.translation.norm() > kMinBaseline * camera_height_m_;
}

/// The strip along the path, where it isn't the vehicle's own and detectors see road.
Image RoadFollower::road_region(const TrackedFrame& present, const DrivenPath& path, const GroundPlane& road,
                                StageClock& clock) {
  RegionOptions options;
  static_cast<StripOptions&>(options) = options_.keyframe.region;
  options.polygon_px = options_.road.region.polygon_px;
  const Image strip = region_mask(path, road, *camera_, options);
  Image allowed = intersect_masks(tracking_mask_, present.road_mask);
  if (detector_) {
    clock.lap("road detection");
    allowed = intersect_masks(allowed, detector_->advance(present.frame.image, warp_));
    clock.lap("road network");
  }
  return restrict_region(strip, allowed);
}

void RoadFollower::look(const TrackedFrame& present, const MapTrail& trail, double unit_m, StageClock& clock) {
  const GroundPlane road = expected_road(trail.latest().cam_from_world);
  const std::vector<RigidTransform> poses = trail.world_from_cam();
  const Trail way = trail_of(poses, unit_m, options_.scale.tie_m + 1.0);
  path_ = path_of_trail(way, options_.scale.ahead, road.normal_in_cam, mounting_.mounting().forward_in_cam());
  if (due_) {
    region_ = road_region(present, path_, road, clock);
    road_.look(present.frame.image, present.index, region_);
  }
}

ScaleKeeper::Input RoadFollower::observe(const MapTrail& trail) {
  const MapTrail::Frame& here = trail.latest();
  const auto& frames = trail.frames();
  std::vector<RigidTransform> cam_from_world;
  for (const MapTrail::Frame& frame : frames) {
    while (!cam_from_world.empty() && frames.front().index + static_cast<int>(cam_from_world.size()) < frame.index) {
      cam_from_world.push_back(cam_from_world.back());  // of a frame that stood
    }
    cam_from_world.push_back(frame.cam_from_world);
  }
  points_ = road_.points(cam_from_world, frames.front().index);
  ScaleKeeper::Input input;
  input.time_s = here.time_s;
  input.world_from_cam = trail.world_from_cam();
  // By how much the camera has turned since each frame of the trail.
  std::vector<double> turned(cam_from_world.size(), 0.0);
  for (std::size_t k = turned.size(); k-- > 1;) {
    turned[k - 1] = turned[k] + rotation_angle(cam_from_world[k].rotation * cam_from_world[k - 1].rotation.transpose());
  }
  for (const RoadTracks::Point& point : points_) {
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
  return input;
}

void RoadFollower::accept(const ScaleReport& report, const MapTrail& trail) {
  std::set<TrackId> on_plane;
  for (const int i : report.inliers) on_plane.insert(points_[static_cast<std::size_t>(i)].id);
  for (std::size_t i = 0; i < matches_.size(); ++i) {
    if (on_plane.contains(matches_[i].id)) inliers_.push_back(static_cast<int>(i));
  }
  if (!report.measured) return;
  rms_px_ = transfer_rms_px(report.plane_in_cam, trail);
  if (!report.reason.empty()) return;
  const PlaneAngles angles = plane_angles(report.plane_in_cam.normal_in_cam);
  mounting_.accept(angles.pitch_rad, angles.roll_rad, mounting_weight(path_.curvature_per_m, report.measured_sd));
  // A poor fit must not lead the tracking of the road's points.
  constexpr std::size_t kMinInliers = 40;
  constexpr double kMaxSd = 0.03;
  if (report.inliers.size() >= kMinInliers && report.measured_sd <= kMaxSd) {
    road_normal_in_world_ = trail.latest().cam_from_world.rotation.transpose() * report.plane_in_cam.normal_in_cam;
  }
}

/// @param road_in_cam  In the map's unit, as the trail is.
double RoadFollower::transfer_rms_px(const GroundPlane& road_in_cam, const MapTrail& trail) const {
  const auto& frames = trail.frames();
  const auto reference = std::find_if(frames.begin(), frames.end(),
                                      [this](const MapTrail::Frame& frame) { return frame.index == reference_; });
  if (reference == frames.end()) return 0.0;
  const RigidTransform reference_from_cam = reference->cam_from_world * trail.latest().cam_from_world.inverse();
  const Eigen::Matrix3d homography =
      homography_of_plane(road_in_cam.seen_from(reference_from_cam), reference_from_cam.inverse());
  double squares = 0.0;
  int count = 0;
  for (const int i : inliers_) {
    const Match& match = matches_[static_cast<std::size_t>(i)];
    const auto ray = camera_->ray(match.pixel1);
    const auto pixel = ray ? camera_->project(homography * *ray) : std::nullopt;
    if (!pixel) continue;
    squares += (match.pixel2 - *pixel).squaredNorm();
    ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : 0.0;
}

void RoadFollower::describe(FrameDetails& details) const {
  details.reference_image = reference_image_;
  details.region = region_;
  details.road_matches = matches_;
  details.road_inliers = inliers_;
  details.path = path_;
  if (!warp_) return;
  details.cam_from_reference = warp_->cam2_from_cam1;
  details.road = warp_->road_in_cam1;
}

}  // namespace groundscale
