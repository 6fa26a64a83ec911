#include "groundscale/odometry/camera_refiner.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "groundscale/camera/turned_camera.hpp"
#include "groundscale/odometry/turning.hpp"

namespace groundscale {

template <>
std::vector<std::string_view> names_of<CameraRefinement>() {
  return {"none", "online"};
}

CameraRefiner::CameraRefiner(const CameraSetup& setup, const CameraRefineOptions& options)
    : options_(options),
      start_camera_(setup.camera),
      camera_(setup.camera),
      radial_(state_of(CameraParameter::kRadial, setup, options.radial_prior_px, options.radial_model_px)),
      row_(state_of(CameraParameter::kRow, setup, options.row_prior_px, options.row_model_px)),
      recorder_(options.views) {}

CameraRefiner::State CameraRefiner::state_of(CameraParameter parameter, const CameraSetup& setup, double prior_px,
                                             double model_px) const {
  State state;
  state.parameter = parameter;
  state.start = value_of(parameter, *setup.camera);
  state.step = pixel_step(parameter, *setup.camera);
  state.prior_px = prior_px;
  state.model_px = model_px;
  const auto sd = setup.parameter_sds.find(parameter);
  if (sd != setup.parameter_sds.end()) state.prior_px = sd->second / state.step;
  state.sd_px = state.prior_px;
  return state;
}

void CameraRefiner::Mean::add(double value, double sd) {
  information += 1.0 / (sd * sd);
  weighted += value / (sd * sd);
}

void CameraRefiner::restart() {
  recorder_ = DriveRecorder(options_.views);
  world_from_cam_.clear();
  world_from_cam_m_.clear();
  samples_.clear();
  length_m_ = 0.0;
}

void CameraRefiner::add(const Placed& placed, const std::vector<TrackPoint>& tracks) {
  frame_ = placed.frame;
  if (!world_from_cam_.empty()) length_m_ += placed.step_m;
  const RigidTransform camera_from_axes{turn_between(*start_camera_, *camera_), Eigen::Vector3d::Zero()};
  recorder_.add(static_cast<int>(world_from_cam_.size()), placed.frame, tracks);
  world_from_cam_.push_back((camera_from_axes * placed.cam_from_world).inverse());
  world_from_cam_m_.push_back(world_from_cam_.back());
  world_from_cam_m_.back().translation *= placed.unit_m;
  if (placed.measured) samples_.push_back({length_m_, -std::log(*placed.measured), placed.measured_sd});
  if (length_m_ < options_.window_m) return;
  // A turn that is going on belongs to the window.
  constexpr double kLastM = 12.0;
  std::size_t last = world_from_cam_m_.size() - 1;
  const auto& here = world_from_cam_m_.back().translation;
  while (last > 0 && (world_from_cam_m_[last].translation - here).norm() < kLastM) --last;
  const bool turning = turned_deg(std::span(world_from_cam_m_).subspan(last)) > 0.0;
  constexpr double kMostWindows = 2.0;
  if (turning && length_m_ < kMostWindows * options_.window_m) return;
  close_window();
  restart();
}

void CameraRefiner::close_window() {
  const double turned = turned_deg(world_from_cam_m_);
  if (turned < options_.min_turn_deg) return;
  ask_tracks(turned);
  ask_slope();
  combine(radial_);
  combine(row_);
}

void CameraRefiner::ask_tracks(double turned_deg) {
  const auto found = adjust_batch(recorder_.drive(world_from_cam_), camera_,
                                  {{CameraParameter::kRadial}, {CameraParameter::kRow}}, options_.batch);
  if (!found) return;
  const double turn_px = options_.row_turn_px / std::sqrt(turned_deg);
  const double radial_sd = std::hypot(std::sqrt(found->covariance(0, 0)) / radial_.step, turn_px);
  const double row_sd = std::hypot(std::sqrt(found->covariance(1, 1)) / row_.step, turn_px);
  radial_.by_tracks.add((found->values[0] - radial_.start) / radial_.step, radial_sd);
  row_.by_tracks.add((found->values[1] - row_.start) / row_.step, row_sd);
}

void CameraRefiner::ask_slope() {
  const auto slope = fit_scale_slope(samples_);
  if (!slope) return;
  const double change_px = -slope->per_100m / options_.sensitivity;
  const double noise = std::hypot(slope->sd_per_100m, options_.slope_model, change_px * options_.sensitivity_sd);
  radial_.by_slope.add(applied_px(radial_) + change_px, noise / std::abs(options_.sensitivity));
}

void CameraRefiner::combine(State& state) const {
  Mean all;
  all.add(0.0, state.prior_px);
  const auto take = [&all](const Mean& mean, double model_px) {
    if (mean.information > 0.0) {
      all.add(mean.weighted / mean.information, std::hypot(1.0 / std::sqrt(mean.information), model_px));
    }
  };
  take(state.by_tracks, state.model_px);
  take(state.by_slope, 0.0);
  state.value_px = all.weighted / all.information;
  state.sd_px = 1.0 / std::sqrt(all.information);
}

std::optional<CameraPtr> CameraRefiner::next() {
  const double change_px =
      std::max(std::abs(radial_.value_px - applied_px(radial_)), std::abs(row_.value_px - applied_px(row_)));
  if (change_px < options_.least_change_px) return std::nullopt;
  CameraPtr camera = start_camera_;
  CameraEvent event;
  event.frame = frame_;
  for (const State* state : {&radial_, &row_}) {
    const double value = state->start + state->step * state->value_px;
    const auto changed = with_value(state->parameter, value, *camera);
    if (!changed) return std::nullopt;
    camera = *changed;
    event.values[std::string(file_name_of(state->parameter, *camera))] = {value, state->step * state->sd_px};
  }
  camera_ = camera;
  events_.push_back(event);
  restart();
  return camera_;
}

void visit_fields(CameraRefineOptions& options, FieldVisitor& visitor) {
  visitor.field(
      {.key = "refine",
       .unit = "",
       .help = "whether keyframe mode finds radial coefficient and principal row from turns, and goes on with "
               "them"},
      options.refine);
  const auto number = [&visitor](std::string_view key, std::string_view unit, std::string_view help, double& value) {
    visitor.field({.key = key, .unit = unit, .help = help, .min = 1e-6, .max = 1000}, value);
  };
  number("window_m", "m", "of the way, looked at together; a turn isn't cut in two", options.window_m);
  number("min_turn_deg", "deg", "of turning in it, with less it says nothing", options.min_turn_deg);
  number("radial_prior_px", "px", "sd in the corners of the radial coefficient where the camera file has none",
         options.radial_prior_px);
  number("row_prior_px", "px", "sd of the principal point's row where the camera file has none", options.row_prior_px);
  number("radial_model_px", "px", "sd in the corners of what the tracker does to the radial coefficient",
         options.radial_model_px);
  number("row_model_px", "px", "sd of what the tracker does to the principal point's row", options.row_model_px);
  number("row_turn_px", "px", "sd that comes to both, over the root of the turning in degrees", options.row_turn_px);
  number("slope_model", "1/100 m", "sd of the scale's slope that roads add", options.slope_model);
  visitor.field({.key = "sensitivity",
                 .unit = "1/100 m/px",
                 .help = "slope of the scale by the radial coefficient",
                 .min = -10,
                 .max = -1e-6},
                options.sensitivity);
  number("sensitivity_sd", "1/100 m/px", "how much that differs from window to window", options.sensitivity_sd);
  number("least_change_px", "px", "smaller changes wait", options.least_change_px);
  visitor.group("views", options.views);
  visitor.group("batch", options.batch);
}

}  // namespace groundscale
