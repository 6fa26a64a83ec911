#include "groundscale/odometry/pair_chain.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "groundscale/geometry/so3.hpp"
#include "groundscale/odometry/pose_chain.hpp"

namespace groundscale {
namespace {

constexpr double kMinStepTimeS = 1e-3;
constexpr double kMinStructureParallaxPx = 3.0;
/// A step that is a smaller share of what lies before it in the pair is the error of that.
constexpr double kMinShareOfLead = 0.2 / 3.0;

/// Turn over distance from one pose to the next; where the camera hardly moves that is noise, so no more than in the
/// tightest turn of a road vehicle.
double curvature_of(const RigidTransform& before, const RigidTransform& now) {
  constexpr double kTightestPerM = 0.25;
  const double step = (now.translation - before.translation).norm();
  const double turn = log_so3(before.rotation.transpose() * now.rotation).norm();
  return step > 0.0 ? std::min(kTightestPerM, turn / step) : 0.0;
}

}  // namespace

PairChain::PairChain(const CameraSetup& setup, const GroundOptions& options)
    : camera_(setup.camera),
      camera_height_m_(*setup.height_m),
      options_(options),
      mounting_(setup.pitch_rad, setup.roll_rad, setup.yaw_rad, options.settle_after),
      filter_(make_ground_filter(options.filter, *setup.height_m)) {}

const FrameResult& PairChain::begin(FrameResult result) {
  result.state = FrameState::kStill;
  result.reason = "first frame";
  return append(std::move(result), 0.0);
}

std::optional<RoadWarp> PairChain::latest_warp(int from_result) const {
  if (!filter_->started() || results_.back().state == FrameState::kLost) return std::nullopt;
  const RigidTransform& world_from_earlier = online_poses_[static_cast<std::size_t>(from_result)];
  RoadWarp warp;
  warp.cam2_from_cam1 = online_poses_.back().inverse() * world_from_earlier;
  warp.road_in_cam1 = {warp.cam2_from_cam1.rotation.transpose() * filter_->state().normal_in_cam(), camera_height_m_};
  return warp;
}

const FrameResult& PairChain::append(FrameResult result, double step) {
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

double PairChain::shape_sd() const {
  if (online_poses_.size() < 2) return 0.0;
  const RigidTransform& now = online_poses_.back();
  const double turning = options_.turn_sd_m * curvature_of(online_poses_[online_poses_.size() - 2], now);
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
  return std::hypot(turning, options_.crest_sd_m * crest);
}

const FrameResult& PairChain::stand(FrameResult result) {
  result.state = FrameState::kStill;
  result.reason = kStandingStill;
  result.reference = static_cast<int>(results_.size()) - 1;
  filter_->stand(time_since_last(result));
  bridged_in_a_row_ = 0;
  return append(std::move(result), 0.0);
}

const FrameResult& PairChain::rotate(FrameResult result, const PairMotion& pair) {
  result.state = FrameState::kRotating;
  result.reason = "turning without moving";
  result.reference = pair.partner;
  result.reference_from_cam = pair.motion.cam2_from_cam1.rotation.transpose();
  filter_->stand(time_since_last(result));
  bridged_in_a_row_ = 0;
  return append(std::move(result), 0.0);
}

const FrameResult& PairChain::bridge(FrameResult result, std::string reason) {
  constexpr int kMaxBridge = 10;
  result.state = ++bridged_in_a_row_ > kMaxBridge ? FrameState::kLost : FrameState::kBridged;
  result.reason = std::move(reason);
  double step = 0.0;
  if (!results_.empty()) {
    // Constant velocity: the last frame's turn and step once more. After long the turn is over, but not the drive.
    const FrameResult& last = results_.back();
    result.reference = static_cast<int>(results_.size()) - 1;
    const double dt = time_since_last(result);
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
  return append(std::move(result), step);
}

double PairChain::time_since_last(const FrameResult& result) const {
  return std::max(kMinStepTimeS, result.time_s - results_.back().time_s);
}

double PairChain::lead_of(const PairMotion& pair) const {
  const RigidTransform& partner = online_poses_[static_cast<std::size_t>(pair.partner)];
  return (online_poses_.back().translation - partner.translation).norm();
}

GroundStep PairChain::step_of(const PairMotion& pair, double dt_s) const {
  GroundStep step;
  step.dt_s = dt_s;
  const RigidTransform& world_from_partner = online_poses_[static_cast<std::size_t>(pair.partner)];
  const RigidTransform cam_from_partner = pair.motion.cam2_from_cam1;
  step.rotation = cam_from_partner.rotation * world_from_partner.rotation.transpose() * online_poses_.back().rotation;
  step.direction = cam_from_partner.translation;
  if (options_.follow_rotation && filter_->started()) {
    const GroundState state = filter_->state();
    const Eigen::Vector3d normal = state.normal_in_cam();
    const PlaneAngles turned = plane_angles(step.rotation * normal);
    step.pitch_change_rad = turned.pitch_rad - state.pitch_rad;
    step.roll_change_rad = turned.roll_rad - state.roll_rad;
  }
  return step;
}

/// The present step from points that earlier pairs have placed; sets the change of speed of `step`. 0 where unknown.
double PairChain::step_from_structure(const PairMotion& pair, GroundStep& step) const {
  const RigidTransform& partner = online_poses_[static_cast<std::size_t>(pair.partner)];
  const auto found = distance_from_structure(structure_, pair.rays, pair.motion, partner.translation,
                                             camera_->focal_px(), kMinStructureParallaxPx);
  if (!found) return 0.0;
  const double lead = lead_of(pair);
  const double present = found->distance - lead;
  const FrameResult& last = results_.back();
  const double last_dt = results_.size() < 2 ? step.dt_s : last.time_s - results_[results_.size() - 2].time_s;
  if (!(present > kMinShareOfLead * lead) || !(last.online_step_m > 0.0) || !(last_dt > 0.0))
    return std::max(0.0, present);
  step.log_speed_change = std::log(present / step.dt_s / (last.online_step_m / last_dt));
  constexpr double kModelSd = 0.01;  // what calibration and slipping tracks do, a pair
  step.log_speed_change_sd = std::hypot(found->log_sd, kModelSd) * found->distance / present;
  return present;
}

const FrameResult& PairChain::move(FrameResult result, const PairMotion& pair, const MeasureRoad& measure) {
  result.state = FrameState::kMoving;
  result.reference = pair.partner;
  result.reference_from_cam = pair.motion.cam2_from_cam1.rotation.transpose();
  result.direction_in_reference = (-result.reference_from_cam * pair.motion.cam2_from_cam1.translation).normalized();
  const double dt = time_since_last(result);

  GroundStep step = step_of(pair, dt);
  const double structure_step = step_from_structure(pair, step);
  if (!options_.use_structure) step.log_speed_change.reset();
  filter_->predict(step);
  const double lead = lead_of(pair);
  double expected_step = filter_->started() ? filter_->state().speed_mps * dt : structure_step;
  if (expected_step <= 0.0) expected_step = results_.back().online_step_m > 0.0 ? results_.back().online_step_m : 1.0;

  const auto measured = measure(lead + expected_step, result);
  std::optional<GroundObservation> observation;
  if (measured) {
    observation = observe(*measured, pair, result);
    observation->step_time_s = dt;
    result.reason = judge(pair, *measured, *observation, lead + expected_step, dt);
  } else {
    result.reason = measured.error().message;
  }
  const auto logged = speed_ ? speed_->step(results_.back().time_s, result.time_s) : std::nullopt;
  if (measured && result.reason.empty()) {
    expected_step = take_measured(pair, *observation, measured->curvature_per_m, expected_step, result);
    if (logged) speed_->compare(*logged, expected_step);
  } else {
    expected_step = take_logged(logged, dt, expected_step, result);
  }
  // Over the online distance of the pair, so that the raw step is the same share of the online step.
  if (observation) {
    result.raw_over_online = std::exp(observation->log_distance) / (lead_of(pair) + expected_step);
  }
  if (!result.reason.empty()) {
    // What a speed log keeps right is in no doubt.
    if (++refused_in_a_row_ % options_.reopen_after == 0 && !result.by_speed_log) filter_->reopen();
  }
  result.scaled = scaled_;
  bridged_in_a_row_ = 0;
  append(std::move(result), expected_step);

  const RigidTransform& partner_pose = online_poses_[static_cast<std::size_t>(pair.partner)];
  structure_ = triangulate_pair(pair.rays, pair.motion, partner_pose,
                                (online_poses_.back().translation - partner_pose.translation).norm(),
                                camera_->focal_px(), kMinStructureParallaxPx);
  return results_.back();
}

/// What the filter is told of a measurement; pitch, roll and sd of `result` are filled in.
GroundObservation PairChain::observe(const RoadMeasurement& measured, const PairMotion& pair,
                                     FrameResult& result) const {
  const GroundPlane& plane = measured.plane.plane;
  GroundObservation observation = observation_of(plane, measured.plane.covariance_of_m, camera_height_m_);
  result.pitch_rad = observation.pitch_rad;
  result.roll_rad = observation.roll_rad;
  result.raw_sd = enlarged_log_sd(observation);
  if (options_.follow_rotation) {
    const PlaneAngles now = plane_angles(pair.motion.cam2_from_cam1.rotation * plane.normal_in_cam);
    observation.pitch_rad = now.pitch_rad;
    observation.roll_rad = now.roll_rad;
  }
  return observation;
}

/// An accepted measurement goes into the filter. @return the step by it.
double PairChain::take_measured(const PairMotion& pair, GroundObservation observation, double curvature_per_m,
                                double expected_step, FrameResult& result) {
  refused_in_a_row_ = 0;
  mounting_.accept(*result.pitch_rad, *result.roll_rad, mounting_weight(curvature_per_m, result.raw_sd));
  const double distance = std::exp(observation.log_distance);
  const double expected = lead_of(pair) + expected_step;
  const bool was_scaled = scaled_;
  if (!scaled_) take_scale(distance, expected);
  observation.lead_m = lead_of(pair);
  // A pair that is shorter than what of it is thought to lie behind: that was too much, and so is what is expected of
  // the present step, by the same factor.
  if (was_scaled && distance < (1.0 + kMinShareOfLead) * observation.lead_m) observation.lead_m *= distance / expected;
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
double PairChain::take_logged(const std::optional<LoggedStep>& logged, double dt_s, double expected_step,
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
bool PairChain::start_by_log(const LoggedStep& logged, double dt_s, double expected_step) {
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

void PairChain::take_scale(double distance_m, double provisional_distance) {
  const double factor = distance_m / provisional_distance;
  for (FrameResult& result : results_) {
    result.online_step_m *= factor;
    if (result.raw_over_online) *result.raw_over_online /= factor;  // metres over what has become metres now
    result.scaled = true;
  }
  for (RigidTransform& pose : online_poses_) pose.translation *= factor;
  scaled_ = true;
}

void PairChain::finish() {
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

std::vector<RigidTransform> PairChain::final_poses() const {
  std::vector<double> steps;
  for (const FrameResult& result : results_) steps.push_back(result.step_m);
  return chain_poses(results_, steps);
}

bool PairChain::needs_search() const {
  const bool after_loss = !results_.empty() && results_.back().state == FrameState::kLost;
  return !scaled_ || after_loss || (refused_in_a_row_ > 0 && refused_in_a_row_ % options_.search_after == 0);
}

RoadWarp PairChain::expected_warp(const RigidTransform& cam2_from_cam1, double expected_distance_m) const {
  RoadWarp warp;
  warp.cam2_from_cam1 = {cam2_from_cam1.rotation, expected_distance_m * cam2_from_cam1.translation};
  warp.road_in_cam1 = {mounting_.mean_normal(), camera_height_m_};
  // Where one looks anew, what the filter has last thought may be the reason why nothing was found.
  if (filter_->started() && !needs_search()) {
    const GroundState state = filter_->state();
    const Eigen::Vector3d normal = state.normal_in_cam();
    warp.road_in_cam1.normal_in_cam =
        options_.follow_rotation ? Eigen::Vector3d(warp.cam2_from_cam1.rotation.transpose() * normal) : normal;
  }
  return warp;
}

std::string PairChain::judge(const PairMotion& pair, const RoadMeasurement& measured,
                             const GroundObservation& observation, double expected_distance_m,
                             double step_time_s) const {
  GateContext context;
  context.mounting_normal = mounting_.mounting().normal_in_cam();
  context.mounting_settled = mounting_.settled();
  context.mean_normal = mounting_.mean_normal();
  context.filter_started = filter_->started() && ground_seen_;
  context.expected_distance_m = expected_distance_m;
  context.expected_log_sd = filter_->started() ? filter_->state().log_speed_sd : 0.0;
  context.step_time_s = step_time_s;
  context.pair_time_s = step_time_s + results_.back().time_s - results_[static_cast<std::size_t>(pair.partner)].time_s;
  GateCandidate candidate;
  candidate.initial_plane = measured.plane.initial_plane;
  candidate.plane = measured.plane.plane;
  candidate.inlier_rays = measured.inlier_rays;
  candidate.distance_m = std::exp(observation.log_distance);
  candidate.log_sd = enlarged_log_sd(observation);
  return refusal(candidate, context, options_.gates);
}

double PairChain::enlarged_log_sd(const GroundObservation& observation) const {
  return std::sqrt(options_.filter.formal_variance_factor * observation.covariance(2, 2));
}

}  // namespace groundscale
