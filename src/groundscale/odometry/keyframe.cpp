#include "groundscale/odometry/keyframe.hpp"

#include <algorithm>
#include <utility>

#include "groundscale/camera/turned_camera.hpp"

namespace groundscale {
namespace {

/// @param points  Ids ascending. @return null where the id isn't among them.
const TrackPoint* find_point(const std::vector<TrackPoint>& points, TrackId id) {
  const auto found = std::lower_bound(points.begin(), points.end(), id,
                                      [](const TrackPoint& point, TrackId wanted) { return point.id < wanted; });
  return found != points.end() && found->id == id ? &*found : nullptr;
}

/// Road points have ids of their own, which in the map lie beyond those of the tracker.
constexpr TrackId kFirstRoadId = TrackId{1} << 40;

}  // namespace

Result<std::unique_ptr<Odometry>> make_odometry(const CameraSetup& setup, const OdometryOptions& options) {
  if (options.odometry.mode == OdometryMode::kPairwise) {
    auto pairwise = PairwiseOdometry::create(setup, options);
    if (!pairwise) return pairwise.error();
    return std::unique_ptr<Odometry>(std::make_unique<PairwiseOdometry>(std::move(*pairwise)));
  }
  auto keyframe = KeyframeOdometry::create(setup, options);
  if (!keyframe) return keyframe.error();
  return std::unique_ptr<Odometry>(std::move(*keyframe));
}

Result<std::unique_ptr<KeyframeOdometry>> KeyframeOdometry::create(const CameraSetup& setup,
                                                                   const OdometryOptions& options) {
  auto pairwise = PairwiseOdometry::create(setup, options);
  if (!pairwise) return pairwise.error();
  return std::unique_ptr<KeyframeOdometry>(new KeyframeOdometry(setup, options, std::move(*pairwise)));
}

KeyframeOdometry::KeyframeOdometry(const CameraSetup& setup, const OdometryOptions& options, PairwiseOdometry pairwise)
    : start_camera_(setup.camera),
      camera_(setup.camera),
      options_(options),
      tracking_mask_(allowed_of(setup.vehicle_mask)),
      rng_(static_cast<std::uint64_t>(options.seed)),
      tracker_(options.tracking),
      road_(setup, options, pairwise),
      speed_(pairwise.shared_speed()),
      bridge_(setup, options, std::move(pairwise)),
      map_(setup.camera, options.keyframe.map),
      lost_(setup.camera, options.keyframe.resection),
      keeper_(*setup.height_m, options.odometry.scale_correction, options.scale),
      refiner_(setup, options.camera) {}

const FrameResult& KeyframeOdometry::advance(const Frame& frame, const Image& road_mask) {
  landmarks_.clear();
  agreeing_.clear();
  clock_.skip();
  TrackedFrame present{frame, road_mask, {}, static_cast<int>(results_.size())};
  const Tracker before = tracker_;
  if (!frame.image.empty()) {
    tracker_.advance(frame.image, tracking_mask_);
  }
  present.tracked = {tracker_.points(), tracker_.followed()};
  clock_.lap("tracking");
  FrameResult result;
  result.frame = frame.index;
  result.time_s = frame.time_s;
  result.scaled = scaled_;
  result.tracks = static_cast<int>(present.tracked.points.size());
  result.tracks_kept = present.tracked.followed;
  const bool has_map = mapping_ || lost_.waiting();
  const FrameResult& done = has_map ? map_frame(std::move(result), present) : bridge(present);
  // At a halt all frames are compared with its first one: tracks don't creep away, nor do cars that pass wipe them out.
  if (done.state == FrameState::kStill && done.reason == kStandingStill) tracker_ = before;
  if (!frame.image.empty() && done.state != FrameState::kStill) {
    constexpr std::size_t kRecentFrames = 40;
    recent_.push_back(std::move(present));
    if (recent_.size() > kRecentFrames) recent_.pop_front();
  }
  return done;
}

bool KeyframeOdometry::stands_still(const TrackedPoints& tracked) const {
  Matches matches = match_by_id(halt_points_, tracked.points);
  std::erase_if(matches, [this](const Match& match) { return map_.point_of(match.id) == nullptr; });
  const double share = results_.back().state == FrameState::kStill ? kShareAtHalt : 0.75;
  return has_stood_still(ray_pairs(matches, *camera_), camera_->focal_px(), options_.motion, share);
}

std::optional<RigidTransform> KeyframeOdometry::locate(const TrackedPoints& tracked, double time_s,
                                                       FrameResult& result) {
  std::vector<PointSight> sights;
  for (const TrackPoint& point : tracked.points) {
    const Eigen::Vector3d* known = map_.point_of(point.id);
    if (known == nullptr) continue;
    sights.push_back({*known, point.pixel});
    landmarks_.push_back(point.id);
  }
  result.matches = static_cast<int>(sights.size());
  constexpr double kMinShare = 0.5;
  const auto enough = [&sights](const Result<Resection>& found) {
    return found && static_cast<double>(found->inliers.size()) >= kMinShare * static_cast<double>(sights.size());
  };
  auto found = refine_pose(sights, *camera_, trail_.predicted_pose(time_s), options_.keyframe.resection);
  if (!enough(found)) {
    auto again = resect(sights, *camera_, options_.keyframe.resection, rng_);
    if (again && (!found || again->inliers.size() > found->inliers.size())) found = std::move(again);
  }
  if (!found) {
    landmarks_.clear();
    result.reason = found.error().message;
    return std::nullopt;
  }
  std::vector<bool> agreed(sights.size(), false);
  for (const int i : found->inliers) agreed[static_cast<std::size_t>(i)] = true;
  map_.judge(landmarks_, agreed);
  result.inliers = static_cast<int>(found->inliers.size());
  result.rms_px = found->rms_px;
  agreeing_ = std::move(found->inliers);
  return found->cam_from_world;
}

bool KeyframeOdometry::wants_keyframe(const TrackedPoints& tracked) const {
  const Keyframe& last = map_.keyframes().back();
  const Matches matches = match_by_id(last.points, tracked.points);
  // The road's points are followed elsewhere.
  const auto own = std::count_if(last.points.begin(), last.points.end(),
                                 [](const TrackPoint& point) { return point.id < kFirstRoadId; });
  const double share = static_cast<double>(matches.size()) / std::max(1.0, static_cast<double>(own));
  if (share < options_.keyframe.min_share) return true;
  return fit_rotation(ray_pairs(matches, *camera_), camera_->focal_px()).parallax_px >=
         options_.keyframe.min_parallax_px;
}

const FrameResult& KeyframeOdometry::map_frame(FrameResult result, TrackedFrame& present) {
  if (present.frame.image.empty() && mapping_) return coast(std::move(result), present, present.frame.problem);
  if (mapping_ && stands_still(present.tracked)) return stand(std::move(result), present);
  auto pose = mapping_ ? locate(present.tracked, present.frame.time_s, result) : std::nullopt;
  if (!pose) pose = find_again(present, result);
  clock_.lap("pose");
  if (!pose) {
    if (mapping_) lose_map(present);
    return bridge(present);
  }
  close_gap(present, *pose);
  result.state = FrameState::kMoving;
  const Keyframe& keyframe = map_.keyframes().back();
  const RigidTransform cam_from_keyframe = trail_.add(present.index, present.frame.time_s, *pose, keyframe);
  halt_points_ = present.tracked.points;
  road_.follow(present, trail_, keeper_.held());
  clock_.lap("road tracking");
  links_.add({keyframe.frame, cam_from_keyframe.inverse(), keeper_.held(), true, false});
  if (wants_keyframe(present.tracked)) add_keyframe(present, *pose);
  trail_.follow(map_);
  clock_.lap("map");
  measure_scale(result, present);
  links_.latest().unit_m = keeper_.held();
  links_.place_keyframes(map_);
  const RigidTransform world_from_cam = links_.latest_pose_m(map_);
  if (result.raw_over_online) {
    // The measurement is of the map as it is now; the online step also makes up for what the frame before didn't know.
    const RigidTransform step = trail_.latest_step();
    const double online = (world_from_cam.translation - online_poses_.back().translation).norm();
    if (online > 0.0) *result.raw_over_online *= links_.latest().unit_m * step.translation.norm() / online;
  }
  const FrameResult& done = append(std::move(result), world_from_cam);
  refine_camera(done);
  return done;
}

/// The frame takes part in finding the camera.
void KeyframeOdometry::refine_camera(const FrameResult& result) {
  if (options_.camera.refine == CameraRefinement::kNone) return;
  CameraRefiner::Placed placed{.frame = result.frame,
                               .cam_from_world = trail_.latest().cam_from_world,
                               .unit_m = keeper_.held(),
                               .step_m = result.online_step_m};
  if (result.accepted()) {
    placed.measured = *result.map_scale * *result.drift_ratio;
    placed.measured_sd = result.raw_sd;
  }
  refiner_.add(placed, tracker_.points());
  clock_.lap("camera");
}

/// What was seen is seen by another camera, whose axes are turned so that poses and points stay.
void KeyframeOdometry::use_camera(const CameraPtr& camera) {
  camera_from_axes_ = turn_between(*start_camera_, *camera);
  camera_ = std::make_shared<TurnedCamera>(camera, camera_from_axes_);
  map_.use_camera(camera_);
  road_.use_camera(camera_);
  lost_.use_camera(camera_);
  bridge_.use_camera(camera_);
}

Mounting KeyframeOdometry::mounting() const {
  Mounting mounting = road_.mounting().mounting();
  const PlaneAngles angles = plane_angles(camera_from_axes_ * mounting.normal_in_cam());
  mounting.pitch_rad = angles.pitch_rad;
  mounting.roll_rad = angles.roll_rad;
  return mounting;
}

const FrameResult& KeyframeOdometry::stand(FrameResult result, const TrackedFrame& present) {
  result.state = FrameState::kStill;
  result.reason = kStandingStill;
  located_ = present.index;
  links_.add({present.index - 1, {}, 1.0, false, false});
  keeper_.pass(present.frame.time_s, 0.0);
  trail_.stand(present.frame.time_s);
  return append(std::move(result), online_poses_.back());
}

/// The present frame, whose link is the latest, becomes a keyframe.
void KeyframeOdometry::add_keyframe(const TrackedFrame& present, const RigidTransform& cam_from_world) {
  links_.latest().is_keyframe = true;
  links_.latest().as_tracked = links_.latest().reference_from_cam;
  std::vector<TrackPoint> points = present.tracked.points;
  // Points of the road, which are tracked better than others so near.
  for (const Match& match : road_.matches()) points.push_back({match.id + kFirstRoadId, match.pixel2});
  if (options_.camera.refine == CameraRefinement::kOnline) {
    if (const auto camera = refiner_.next()) use_camera(*camera);
  }
  const int serial = map_.add(present.index, cam_from_world, points);
  if (pending_correction_) correct_map(present.frame.index);
  map_.triangulate();
  map_.adjust();
  trail_.hang_latest_on_itself(serial);
}

/// Road and scale.
void KeyframeOdometry::measure_scale(FrameResult& result, const TrackedFrame& present) {
  const double unit_m = keeper_.held();
  road_.look(present, trail_, unit_m, clock_);
  clock_.lap("road detection");
  ScaleKeeper::Input input = road_.observe(trail_);
  clock_.lap("road points");
  const std::optional<LoggedStep> logged = logged_step();
  if (logged && speed_->agrees()) input.logged_step = logged;
  const ScaleReport report = keeper_.advance(input);
  if (logged && report.reason.empty()) {
    const double ground_m = *report.measured * trail_.latest_step().translation.norm();
    if (ground_m > 0.0) speed_->compare(*logged, ground_m);
  }
  result.by_speed_log = report.by_log;
  hold_by_ground(report);
  road_.accept(report, trail_);
  take_report(result, report);
  result.road_rms_px = road_.rms_px();
  clock_.lap("scale");
  // What lies too far behind for the plane is forgotten.
  constexpr double kKeptM = 25.0;
  trail_.forget_behind(kKeptM, unit_m);
  road_.forget_before(trail_.frames().front().index);
}

/// What the speed log says of the latest step; nothing where that is partly guessed.
std::optional<LoggedStep> KeyframeOdometry::logged_step() const {
  const FrameState before = results_.back().state;
  if (!speed_ || before == FrameState::kBridged || before == FrameState::kLost) return std::nullopt;
  const auto& frames = trail_.frames();
  return frames.size() < 2 ? std::nullopt : speed_->step((frames.end() - 2)->time_s, frames.back().time_s);
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

void KeyframeOdometry::take_report(FrameResult& result, const ScaleReport& report) {
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
  const PlaneAngles angles = plane_angles(camera_from_axes_ * report.plane_in_cam.normal_in_cam);
  result.pitch_rad = angles.pitch_rad;
  result.roll_rad = angles.roll_rad;
  if (report.correction) pending_correction_ = report.correction;
}

/// Algorithm 2: the local map grows by lambda about its oldest keyframe, and what was seen before it is left alone.
void KeyframeOdometry::correct_map(int frame) {
  const double lambda = *pending_correction_;
  const Keyframe& oldest = map_.scale(lambda);
  keeper_.corrected(lambda);
  corrections_.push_back({frame, lambda, last_drift_ratio_, std::nullopt});
  correction_open_ = true;
  pending_correction_.reset();
  refiner_.restart();
  // The road's points are placed by the scaled part of the trail alone.
  trail_.forget_before(oldest.frame);
  trail_.scale(lambda);
}

const FrameResult& KeyframeOdometry::coast(FrameResult result, const TrackedFrame& present, std::string reason) {
  const double time_s = present.frame.time_s;
  const Keyframe& last = map_.keyframes().back();
  const RigidTransform cam_from_keyframe = trail_.add(present.index, time_s, trail_.predicted_pose(time_s), last);
  result.state = FrameState::kBridged;
  result.reason = std::move(reason);
  links_.add({last.frame, cam_from_keyframe.inverse(), keeper_.held(), true, false});
  keeper_.pass(time_s, 0.0);
  return append(std::move(result), links_.latest_pose_m(map_));
}

const FrameResult& KeyframeOdometry::append(FrameResult result, const RigidTransform& world_from_cam_m) {
  enter_link(links_.latest(), result);
  if (!online_poses_.empty()) {
    result.online_step_m = (world_from_cam_m.translation - online_poses_.back().translation).norm();
  }
  online_poses_.emplace_back();
  online_output_.emplace_back();
  place(online_poses_.size() - 1, world_from_cam_m);
  results_.push_back(std::move(result));
  return results_.back();
}

/// Online pose of frame k, in the start camera's axes and as it comes out.
void KeyframeOdometry::place(std::size_t k, const RigidTransform& world_from_cam_m) {
  online_poses_[k] = world_from_cam_m;
  online_output_[k] = world_from_cam_m;
  online_output_[k].rotation *= camera_from_axes_.transpose();
}

FrameDetails KeyframeOdometry::details() const {
  const int latest = static_cast<int>(results_.size()) - 1;
  const std::vector<int>& bridged = bridge_.frames();
  if (!bridged.empty() && bridged.back() == latest) return bridge_.pairwise().details();
  FrameDetails details;
  if (results_.empty() || results_.back().state != FrameState::kMoving) return details;  // nothing was measured
  road_.describe(details);
  details.inliers = agreeing_;
  for (const TrackId id : landmarks_) {
    const TrackPoint* now = find_point(recent_.back().tracked.points, id);
    const TrackPoint* before = find_point(recent_[recent_.size() - 2].tracked.points, id);
    details.matches.push_back({id, (before != nullptr ? before : now)->pixel, now->pixel});
  }
  details.pairs = ray_pairs(details.matches, *camera_);
  return details;
}

void KeyframeOdometry::finish() {
  if (!mapping_) close_bridge();
  std::vector<MapScaleFilter::Smoothed> smoothed;
  if (keeper_.follows_ground()) smoothed = keeper_.smoothed();
  final_poses_ = links_.poses_m(smoothed);
  // In the axes of the camera as known in the end, the first one's too.
  const RigidTransform turn{camera_from_axes_, Eigen::Vector3d::Zero()};
  for (RigidTransform& pose : final_poses_) pose = turn * pose * turn.inverse();
  for (std::size_t k = 0; k < results_.size(); ++k) {
    const PoseLink& link = links_[static_cast<int>(k)];
    if (link.reference < 0) continue;
    results_[k].step_m = k == 0 ? 0.0 : (final_poses_[k].translation - final_poses_[k - 1].translation).norm();
    results_[k].step_sd = link.by_map && !smoothed.empty() ? smoothed[k].sd : results_[k].online_step_sd;
  }
}

}  // namespace groundscale
