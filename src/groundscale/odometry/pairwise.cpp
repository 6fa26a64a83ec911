#include "groundscale/odometry/pairwise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "groundscale/geometry/so3.hpp"
#include "groundscale/io/speed_file.hpp"
#include "groundscale/odometry/pose_chain.hpp"
#include "groundscale/road/ground_methods.hpp"

namespace groundscale {
namespace {

constexpr double kMinStepTimeS = 1e-3;
constexpr double kMinStructureParallaxPx = 3.0;

/// Turn over distance from one pose to the next; where the camera hardly moves that is noise, so no more than in the
/// tightest turn of a road vehicle.
double curvature_of(const RigidTransform& before, const RigidTransform& now) {
  constexpr double kTightestPerM = 0.25;
  const double step = (now.translation - before.translation).norm();
  const double turn = log_so3(before.rotation.transpose() * now.rotation).norm();
  return step > 0.0 ? std::min(kTightestPerM, turn / step) : 0.0;
}

/// Whether two images differ by less than a grey level on average.
bool same_image(const Image& a, const Image& b) {
  if (a.width() != b.width() || a.height() != b.height()) return false;
  const auto count = static_cast<std::ptrdiff_t>(a.width()) * a.height();
  std::int64_t difference = 0;
  for (std::ptrdiff_t i = 0; i < count; ++i) difference += std::abs(a.data()[i] - b.data()[i]);
  return difference < count;
}

}  // namespace

Image allowed_of(const Image& vehicle_mask) {
  if (vehicle_mask.empty()) return {};
  Image allowed(vehicle_mask.width(), vehicle_mask.height());
  const auto count = static_cast<std::ptrdiff_t>(vehicle_mask.width()) * vehicle_mask.height();
  std::transform(vehicle_mask.data(), vehicle_mask.data() + count, allowed.data(),
                 [](std::uint8_t own) { return static_cast<std::uint8_t>(own == 0 ? 255 : 0); });
  return allowed;
}

Result<PairwiseOdometry> PairwiseOdometry::create(const CameraSetup& setup, const OdometryOptions& options) {
  GS_CHECK(setup.camera != nullptr && setup.height_m.has_value(), "a camera and its height");
  if (const auto valid = options.validate(); !valid) return valid.error();
  use_one_thread();
  PairwiseOdometry odometry(setup, options);
  const Mounting mounting = odometry.mounting_.mounting();
  const GroundPlane road{mounting.normal_in_cam(), *setup.height_m};
  const Image region = restrict_region(
      region_mask({mounting.forward_in_cam(), 0.0}, road, *setup.camera, options.road.region), odometry.tracking_mask_);
  // An unlikely height says more about its unit than about where the road is: the run goes on, with a warning.
  if (mask_area(region) == 0 && *setup.height_m <= kUnlikelyHeightM) {
    if (!options.road.region.polygon_px.empty()) {
      return Error{ErrorCode::kBadInput,
                   "no road is in view: road.region.polygon_px lies outside the image (or behind the vehicle mask)"};
    }
    return Error{ErrorCode::kBadInput,
                 fmt::format("no road is in view: the strip from {} to {} m ahead lies outside the image with this "
                             "height, pitch, roll and yaw (or behind the vehicle mask)",
                             options.road.region.near_m, options.road.region.far_m)};
  }
  if (!options.road.network.file.empty()) {
    auto detector = RoadDetector::open(options.road.network, setup.camera);
    if (!detector) return detector.error();
    odometry.detector_ = std::make_shared<RoadDetector>(std::move(*detector));
  }
  if (!options.scale.speed.file.empty()) {
    auto log = read_speed_log(options.scale.speed.file);
    if (!log) return Error{log.error().code, "scale.speed: " + log.error().message};
    odometry.speed_ = std::make_shared<SpeedReference>(std::move(*log), options.scale.speed);
  }
  return odometry;
}

PairwiseOdometry::PairwiseOdometry(const CameraSetup& setup, const OdometryOptions& options)
    : camera_(setup.camera),
      camera_height_m_(*setup.height_m),
      tracking_mask_(allowed_of(setup.vehicle_mask)),
      options_(options),
      refine_warp_(make_memoryless<estimate_plane_sparse>(options.ground.plane)),
      estimate_plane_(find_ground_method(options.ground.method)->make(options.ground.plane)),
      rng_(static_cast<std::uint64_t>(options.seed)),
      tracker_(options.tracking),
      road_matcher_(options.road.tracking),
      mounting_(setup.pitch_rad, setup.roll_rad, setup.yaw_rad, options.ground.settle_after),
      filter_(make_ground_filter(options.ground.filter, *setup.height_m)),
      views_(options.pair, options.motion) {}

const FrameResult& PairwiseOdometry::advance(const Frame& frame, const Image& road_mask) {
  clock_.skip();
  if (!frame.image.empty()) {
    tracker_.advance(frame.image, tracking_mask_);
    clock_.lap("tracking");
  }
  return advance(frame, road_mask, {tracker_.points(), tracker_.followed()});
}

const FrameResult& PairwiseOdometry::advance(const Frame& frame, const Image& road_mask, const TrackedPoints& tracked) {
  details_ = {};
  tracked_ = tracked;
  road_mask_ = road_mask;
  clock_.skip();
  FrameResult result;
  result.frame = frame.index;
  result.time_s = frame.time_s;
  result.scaled = scaled_;
  if (frame.image.empty()) return bridge(std::move(result), frame.problem, frame);

  result.tracks = static_cast<int>(tracked_.points.size());
  result.tracks_kept = tracked_.followed;
  if (views_.empty()) {
    result.state = FrameState::kStill;
    result.reason = "first frame";
    append(std::move(result), 0.0);
    remember_view(frame, static_cast<int>(results_.size()) - 1);
    return results_.back();
  }
  const bool standing = results_.size() > 1 && results_.back().state == FrameState::kStill;
  Pair pair = views_.pair_with(tracked_.points, *camera_, standing);
  result.matches = static_cast<int>(pair.matches.size());
  if (pair.motion.state != MotionState::kStill) {
    pair.motion = estimate_motion(pair.rays, camera_->focal_px(), options_.motion, rng_, last_motion_);
  }
  result.inliers = static_cast<int>(pair.motion.inliers.size());
  result.rms_px = pair.motion.rms_px;
  clock_.lap("motion");
  details_.matches = pair.matches;
  details_.pairs = pair.rays;
  details_.inliers = pair.motion.inliers;
  switch (pair.motion.state) {
    case MotionState::kStill:
      return stand(std::move(result), frame);
    case MotionState::kRotating:
      return rotate(std::move(result), pair, frame);
    case MotionState::kMoving:
      return move(std::move(result), std::move(pair), frame);
    case MotionState::kLost:
      break;
  }
  // A frozen image; one without anything to see, such as a black one, says nothing of a camera that was moving.
  const bool seeing = !tracked_.points.empty() || results_.back().state == FrameState::kStill;
  if (seeing && same_image(views_.latest().road.image, frame.image)) return stand(std::move(result), frame);
  return bridge(std::move(result), pair.motion.reason, frame);
}

const FrameResult& PairwiseOdometry::append(FrameResult result, double step) {
  result.online_step_m = step;
  const RigidTransform pose =
      result.reference < 0
          ? RigidTransform{}
          : place(result, online_poses_[static_cast<std::size_t>(result.reference)], online_poses_.back(), step);
  online_poses_.push_back(pose);
  // Where it stands there is no step to be wrong, and the way back is as long as the halt.
  if (step > 0.0) result.shape_sd = shape_sd();
  if (filter_->started()) result.online_step_sd = std::hypot(filter_->state().log_speed_sd, result.shape_sd);
  filter_->keep();
  results_.push_back(std::move(result));
  return results_.back();
}

double PairwiseOdometry::shape_sd() const {
  if (online_poses_.size() < 2) return 0.0;
  const RigidTransform& now = online_poses_.back();
  const double turning = options_.ground.turn_sd_m * curvature_of(online_poses_[online_poses_.size() - 2], now);
  // Pitch from a few metres back, so that the vehicle's nodding counts little.
  constexpr double kBackM = 10.0;
  std::size_t before = online_poses_.size() - 1;
  const auto distance = [&] { return (now.translation - online_poses_[before].translation).norm(); };
  while (before > 0 && distance() < kBackM) --before;
  if (distance() < 0.5 * kBackM) return turning;
  const Mounting mounting = mounting_.mounting();
  const Eigen::Vector3d forward =
      online_poses_[before].rotation.transpose() * (now.rotation * mounting.forward_in_cam());
  const double crest = std::asin(std::clamp(mounting.normal_in_cam().dot(forward), -1.0, 1.0)) / distance();
  return std::hypot(turning, options_.ground.crest_sd_m * crest);
}

void PairwiseOdometry::remember_view(const Frame& frame, int result_index) {
  View view;
  view.result = result_index;
  view.time_s = frame.time_s;
  view.points = tracked_.points;
  view.road.image = frame.image;
  view.road_mask = road_mask_;
  if (detector_) {
    clock_.lap("filter and poses");
    view.road_mask = intersect_masks(road_mask_, detector_->advance(frame.image, warp_from_latest_view()));
    clock_.lap("road network");
  }
  for (const Match& match : road_matches_) view.road.points.push_back({match.id, match.pixel2});
  road_matches_.clear();
  views_.push(std::move(view));
}

std::optional<RoadWarp> PairwiseOdometry::warp_from_latest_view() const {
  if (views_.empty() || !filter_->started() || results_.back().state == FrameState::kLost) return std::nullopt;
  const RigidTransform& world_from_last = online_poses_[static_cast<std::size_t>(views_.latest().result)];
  RoadWarp warp;
  warp.cam2_from_cam1 = online_poses_.back().inverse() * world_from_last;
  warp.road_in_cam1 = {warp.cam2_from_cam1.rotation.transpose() * filter_->state().normal_in_cam(), camera_height_m_};
  return warp;
}

const FrameResult& PairwiseOdometry::stand(FrameResult result, const Frame& frame) {
  result.state = FrameState::kStill;
  result.reason = kStandingStill;
  result.reference = static_cast<int>(results_.size()) - 1;
  filter_->stand(time_since_last(frame));
  bridged_in_a_row_ = 0;
  return append(std::move(result), 0.0);
}

const FrameResult& PairwiseOdometry::rotate(FrameResult result, const Pair& pair, const Frame& frame) {
  result.state = FrameState::kRotating;
  result.reason = "turning without moving";
  result.reference = pair.partner->result;
  result.reference_from_cam = pair.motion.cam2_from_cam1.rotation.transpose();
  filter_->stand(time_since_last(frame));
  bridged_in_a_row_ = 0;
  append(std::move(result), 0.0);
  remember_view(frame, static_cast<int>(results_.size()) - 1);
  return results_.back();
}

const FrameResult& PairwiseOdometry::bridge(FrameResult result, std::string reason, const Frame& frame) {
  constexpr int kMaxBridge = 10;
  constexpr int kNewStart = 2;
  result.state = ++bridged_in_a_row_ > kMaxBridge ? FrameState::kLost : FrameState::kBridged;
  result.reason = std::move(reason);
  double step = 0.0;
  if (!results_.empty()) {
    // Constant velocity: the last frame's turn and step once more. After long the turn is over, but not the drive.
    const FrameResult& last = results_.back();
    result.reference = static_cast<int>(results_.size()) - 1;
    const double dt = time_since_last(frame);
    if (results_.size() >= 2) {
      const RigidTransform& before = online_poses_[online_poses_.size() - 2];
      const RigidTransform& now = online_poses_.back();
      if (result.state == FrameState::kBridged) {
        result.reference_from_cam = nearest_rotation(before.rotation.transpose() * now.rotation);
      }
      const Eigen::Vector3d moved = now.rotation.transpose() * (now.translation - before.translation);
      if (moved.norm() > 0.0) {
        result.direction_in_reference = result.reference_from_cam * moved.normalized();
        const double last_dt = std::max(kMinStepTimeS, last.time_s - results_[results_.size() - 2].time_s);
        step = moved.norm() * dt / last_dt;
      }
    }
    filter_->predict({.dt_s = dt});
  }
  append(std::move(result), step);
  // A partner from before the gap is best; where it fails as well, tracks begin anew here.
  if (!frame.image.empty() && bridged_in_a_row_ >= kNewStart) {
    remember_view(frame, static_cast<int>(results_.size()) - 1);
  }
  return results_.back();
}

double PairwiseOdometry::time_since_last(const Frame& frame) const {
  return std::max(kMinStepTimeS, frame.time_s - results_.back().time_s);
}

double PairwiseOdometry::lead_of(const Pair& pair) const {
  const RigidTransform& partner = online_poses_[static_cast<std::size_t>(pair.partner->result)];
  return (online_poses_.back().translation - partner.translation).norm();
}

GroundStep PairwiseOdometry::step_of(const Pair& pair, double dt_s) const {
  GroundStep step;
  step.dt_s = dt_s;
  const RigidTransform& world_from_partner = online_poses_[static_cast<std::size_t>(pair.partner->result)];
  const RigidTransform cam_from_partner = pair.motion.cam2_from_cam1;
  step.rotation = cam_from_partner.rotation * world_from_partner.rotation.transpose() * online_poses_.back().rotation;
  step.direction = cam_from_partner.translation;
  if (options_.ground.follow_rotation && filter_->started()) {
    const GroundState state = filter_->state();
    const Eigen::Vector3d normal = state.normal_in_cam();
    const PlaneAngles turned = plane_angles(step.rotation * normal);
    step.pitch_change_rad = turned.pitch_rad - state.pitch_rad;
    step.roll_change_rad = turned.roll_rad - state.roll_rad;
  }
  return step;
}

/// The present step from points that earlier pairs have placed; sets the change of speed of `step`. 0 where unknown.
double PairwiseOdometry::step_from_structure(const Pair& pair, GroundStep& step) const {
  const RigidTransform& partner = online_poses_[static_cast<std::size_t>(pair.partner->result)];
  const auto found = distance_from_structure(structure_, pair.rays, pair.motion, partner.translation,
                                             camera_->focal_px(), kMinStructureParallaxPx);
  if (!found) return 0.0;
  const double lead = lead_of(pair);
  const double present = found->distance - lead;
  const FrameResult& last = results_.back();
  const double last_dt = results_.size() < 2 ? step.dt_s : last.time_s - results_[results_.size() - 2].time_s;
  constexpr double kMinShare = 0.2 / 3.0;  // of the lead: below, the step is the error's
  if (!(present > kMinShare * lead) || !(last.online_step_m > 0.0) || !(last_dt > 0.0)) return std::max(0.0, present);
  step.log_speed_change = std::log(present / step.dt_s / (last.online_step_m / last_dt));
  constexpr double kModelSd = 0.01;  // what calibration and slipping tracks do, a pair
  step.log_speed_change_sd = std::hypot(found->log_sd, kModelSd) * found->distance / present;
  return present;
}

const FrameResult& PairwiseOdometry::move(FrameResult result, Pair pair, const Frame& frame) {
  result.state = FrameState::kMoving;
  result.reference = pair.partner->result;
  result.reference_from_cam = pair.motion.cam2_from_cam1.rotation.transpose();
  result.direction_in_reference = (-result.reference_from_cam * pair.motion.cam2_from_cam1.translation).normalized();
  const double dt = time_since_last(frame);

  GroundStep step = step_of(pair, dt);
  const double structure_step = step_from_structure(pair, step);
  if (!options_.ground.use_structure) step.log_speed_change.reset();
  filter_->predict(step);
  const double lead = lead_of(pair);
  double expected_step = filter_->started() ? filter_->state().speed_mps * dt : structure_step;
  if (expected_step <= 0.0) expected_step = results_.back().online_step_m > 0.0 ? results_.back().online_step_m : 1.0;

  auto measured = measure_road(pair, lead + expected_step, result, frame);
  if (measured) {
    result.raw_sd = enlarged_log_sd(measured->observation);
    measured->observation.step_time_s = dt;
    result.reason = measured->refusal;
  }
  const auto logged = speed_ ? speed_->step(results_.back().time_s, frame.time_s) : std::nullopt;
  if (measured && measured->refusal.empty()) {
    expected_step = take_measured(pair, measured->observation, expected_step, result);
    if (logged) speed_->compare(*logged, expected_step);
  } else {
    expected_step = take_logged(logged, dt, expected_step, result);
  }
  // Over the online distance of the pair, so that the raw step is the same share of the online step.
  if (measured) {
    result.raw_over_online = std::exp(measured->observation.log_distance) / (lead_of(pair) + expected_step);
  }
  if (!result.reason.empty()) {
    // What a speed log keeps right is in no doubt.
    if (++refused_in_a_row_ % options_.ground.reopen_after == 0 && !result.by_speed_log) filter_->reopen();
  }
  result.scaled = scaled_;
  bridged_in_a_row_ = 0;
  last_motion_ = pair.motion.cam2_from_cam1;
  append(std::move(result), expected_step);

  const RigidTransform& partner_pose = online_poses_[static_cast<std::size_t>(pair.partner->result)];
  structure_ = triangulate_pair(pair.rays, pair.motion, partner_pose,
                                (online_poses_.back().translation - partner_pose.translation).norm(),
                                camera_->focal_px(), kMinStructureParallaxPx);
  remember_view(frame, static_cast<int>(results_.size()) - 1);
  clock_.lap("filter and poses");
  return results_.back();
}

/// An accepted measurement goes into the filter. @return the step by it.
double PairwiseOdometry::take_measured(const Pair& pair, GroundObservation observation, double expected_step,
                                       FrameResult& result) {
  refused_in_a_row_ = 0;
  mounting_.accept(*result.pitch_rad, *result.roll_rad, mounting_weight(details_.path.curvature_per_m, result.raw_sd));
  const double distance = std::exp(observation.log_distance);
  const double expected = lead_of(pair) + expected_step;
  if (!scaled_) take_scale(distance, expected);
  observation.lead_m = lead_of(pair);
  // A log that has begun alone and turns out to be quite wrong is as if it had never been.
  const bool anew = !ground_seen_ && std::abs(std::log(distance / expected)) > kGrossLogRatio;
  if (!filter_->started() || anew) {
    filter_->start(observation);
  } else {
    filter_->update(observation);
  }
  ground_seen_ = true;
  return filter_->state().speed_mps * observation.step_time_s;
}

/// Where no measurement was accepted: what a speed log says goes into the filter. @return the step, changed or not.
double PairwiseOdometry::take_logged(const std::optional<LoggedStep>& logged, double dt_s, double expected_step,
                                     FrameResult& result) {
  if (!logged || !speed_->agrees() || !(expected_step > 0.0)) return expected_step;
  if (!scaled_) {
    if (!start_by_log(*logged, dt_s, expected_step)) return expected_step;
  } else if (is_gross(std::log(logged->distance_m / expected_step), filter_->state().log_speed_sd, *logged)) {
    return expected_step;
  }
  filter_->update_speed(logged->distance_m / dt_s, logged->log_sd);
  result.by_speed_log = true;
  return filter_->state().speed_mps * dt_s;
}

/// The first scale of a drive, where the ground isn't seen: the ground has 10 m to be first.
bool PairwiseOdometry::start_by_log(const LoggedStep& logged, double dt_s, double expected_step) {
  constexpr double kWaitM = 10.0;
  logged_m_ += logged.distance_m;
  logged_units_ += expected_step;
  if (logged_m_ < kWaitM) return false;
  const double factor = logged_m_ / logged_units_;
  take_scale(logged_m_, logged_units_);
  // Of pitch and roll nothing is known but the mounting.
  const PlaneAngles angles = plane_angles(mounting_.mean_normal());
  GroundObservation observation;
  observation.pitch_rad = angles.pitch_rad;
  observation.roll_rad = angles.roll_rad;
  observation.log_distance = std::log(factor * expected_step);
  constexpr double kAngleSd = 0.02;
  observation.covariance.diagonal() << kAngleSd * kAngleSd, kAngleSd * kAngleSd, logged.log_sd * logged.log_sd;
  observation.step_time_s = dt_s;
  filter_->start(observation);
  return true;
}

void PairwiseOdometry::take_scale(double distance_m, double provisional_distance) {
  const double factor = distance_m / provisional_distance;
  for (FrameResult& result : results_) {
    result.online_step_m *= factor;
    if (result.raw_over_online) *result.raw_over_online /= factor;  // metres over what has become metres now
    result.scaled = true;
  }
  for (RigidTransform& pose : online_poses_) pose.translation *= factor;
  scaled_ = true;
}

void PairwiseOdometry::finish() {
  const std::vector<GroundState> states = filter_->smoothed();
  std::optional<std::size_t> first;
  for (std::size_t k = 0; k < results_.size(); ++k) {
    FrameResult& result = results_[k];
    result.step_m = result.online_step_m;
    result.step_sd = result.online_step_sd;
    if (k == 0 || result.online_step_m <= 0.0 || !(states[k].speed_mps > 0.0) || result.online_step_sd <= 0.0) continue;
    const double dt = std::max(kMinStepTimeS, result.time_s - results_[k - 1].time_s);
    result.step_m = states[k].speed_mps * dt;
    result.step_sd = std::hypot(states[k].log_speed_sd, result.shape_sd);
    if (!first) first = k;
  }
  // Steps from before the first measurement hang together with its own step: they follow it.
  if (!first) return;
  const double factor = results_[*first].step_m / results_[*first].online_step_m;
  for (std::size_t k = 0; k < *first; ++k) results_[k].step_m *= factor;
}

std::vector<RigidTransform> PairwiseOdometry::final_poses() const {
  std::vector<double> steps;
  for (const FrameResult& result : results_) steps.push_back(result.step_m);
  return chain_poses(results_, steps);
}

}  // namespace groundscale
