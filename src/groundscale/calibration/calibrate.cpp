#include "groundscale/calibration/calibrate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include <Eigen/LU>
#include <fmt/format.h>

#include "groundscale/core/check.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/odometry/odometry.hpp"

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
/// Order of the parameters everywhere in this file.
constexpr CameraParameter kParameters[] = {CameraParameter::kRadial, CameraParameter::kRow};
constexpr std::size_t kRadial = 0;
constexpr std::size_t kRow = 1;
const std::vector<FreeParameter> kBoth = {{CameraParameter::kRadial}, {CameraParameter::kRow}};

/// A drive as the odometry with one camera saw it.
struct Pass {
  DriveTracks tracks;
  std::optional<ScaleSlope> slope;
  double turned_deg = 0.0;
  double length_m = 0.0;
  int frames = 0;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Turning in pieces of 10 m, so that noise and lane keeping don't add up to turns.
double turned_deg(const std::vector<RigidTransform>& world_from_cam) {
  constexpr double kPieceM = 10.0;
  constexpr double kLeastDeg = 3.0;
  double sum = 0.0;
  std::size_t begin = 0;
  for (std::size_t k = 1; k < world_from_cam.size(); ++k) {
    const RigidTransform from_begin = world_from_cam[begin].inverse() * world_from_cam[k];
    if (from_begin.translation.norm() < kPieceM) continue;
    const double turn_deg = rotation_angle(from_begin.rotation) / kDegree;
    if (turn_deg >= kLeastDeg) sum += turn_deg;
    begin = k;
  }
  return sum;
}

Result<Pass> run_pass(const CalibrationDrive& drive, const CameraSetup& setup, const OdometryOptions& options,
                      const CalibrateOptions& calibrate) {
  auto sequence = drive.open();
  if (!sequence) return sequence.error();
  auto odometry = make_odometry(setup, options);
  if (!odometry) return odometry.error();
  DriveRecorder recorder(calibrate.views);
  Pass pass;
  while (const auto frame = (*sequence)->next()) {
    const FrameResult& result = (*odometry)->advance(*frame);
    if (result.state == FrameState::kMoving) recorder.add(pass.frames, result.frame, (*odometry)->tracks());
    ++pass.frames;
  }
  (*odometry)->finish();
  const std::vector<RigidTransform> poses = (*odometry)->final_poses();
  pass.tracks = recorder.drive(poses);
  pass.turned_deg = turned_deg(poses);
  for (const FrameResult& result : (*odometry)->results()) pass.length_m += result.step_m;
  if (const auto slope = scale_slope((*odometry)->results())) pass.slope = *slope;
  return pass;
}

/// Estimates of several drives by their covariances.
struct Combined {
  Eigen::Vector2d values = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};

Combined combined(const std::vector<BatchResult>& results) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d weighted = Eigen::Vector2d::Zero();
  for (const BatchResult& result : results) {
    const Eigen::Matrix2d own = Eigen::Matrix2d(result.covariance).inverse();
    information += own;
    weighted += own * Eigen::Vector2d(result.values[kRadial], result.values[kRow]);
  }
  Combined sum;
  sum.covariance = information.inverse();
  sum.values = sum.covariance * weighted;
  return sum;
}

template <class Keep>
DriveTracks tracks_of(const DriveTracks& drive, Keep keep) {
  DriveTracks part{drive.views, {}};
  std::copy_if(drive.tracks.begin(), drive.tracks.end(), std::back_inserter(part.tracks), keep);
  return part;
}

/// Every third track is held out where the result is checked.
bool takes_part(const DriveTracks::Track& track) { return track.id % 3 != 0; }

/// The slopes of several drives by their errors.
std::optional<ScaleSlope> combined_slope(const std::vector<Pass>& passes) {
  ScaleSlope sum;
  double information = 0.0;
  for (const Pass& pass : passes) {
    if (!pass.slope) continue;
    constexpr double kLeastSd = 1e-4;
    const double own = 1.0 / std::pow(std::max(kLeastSd, pass.slope->sd_per_100m), 2);
    information += own;
    sum.per_100m += own * pass.slope->per_100m;
    sum.length_m += pass.slope->length_m;
    sum.measurements += pass.slope->measurements;
  }
  if (!(information > 0.0)) return std::nullopt;
  sum.per_100m /= information;
  sum.sd_per_100m = 1.0 / std::sqrt(information);
  return sum;
}

/// The work of one calibration.
class Calibrator {
 public:
  Calibrator(const std::vector<CalibrationDrive>& drives, const CameraSetup& setup, const OdometryOptions& odometry,
             const CalibrateOptions& options)
      : drives_(drives), setup_(setup), odometry_(odometry), options_(options), camera_(setup.camera) {
    odometry_.odometry.mode = OdometryMode::kKeyframe;
    odometry_.odometry.scale_correction = ScaleCorrection::kNone;
    for (const CameraParameter parameter : kParameters) {
      start_.push_back(value_of(parameter, *camera_));
      steps_.push_back(pixel_step(parameter, *camera_));
    }
  }

  Result<Calibration> work();

 private:
  /// A pass over all drives with the present camera.
  Result<void> pass();
  Result<std::vector<BatchResult>> adjust(const std::vector<FreeParameter>& free) const;
  Result<void> find_by_tracks();
  void find_by_slope();
  Result<void> state_uncertainty();
  std::string why_refused(std::size_t j) const;
  Result<void> take_over();
  Result<void> check(Calibration& result);
  CameraPtr camera_with(double radial, double row) const;
  double present(std::size_t j) const { return value_of(kParameters[j], *camera_); }

  const std::vector<CalibrationDrive>& drives_;
  CameraSetup setup_;
  OdometryOptions odometry_;
  const CalibrateOptions& options_;
  CameraPtr camera_;
  std::vector<double> start_, steps_;
  std::vector<Pass> passes_;  ///< With the present camera.
  struct SlopeAt {
    double radial = 0.0;
    ScaleSlope slope;
  };
  std::vector<SlopeAt> slopes_;
  Combined by_tracks_;
  std::vector<double> sds_;            ///< Of by_tracks_.
  std::vector<std::string> disagree_;  ///< Which halves do, and by how much.
  std::optional<ParameterEstimate> by_slope_;
  Calibration calibration_;
};

CameraPtr Calibrator::camera_with(double radial, double row) const {
  const auto bent = with_value(CameraParameter::kRadial, radial, *setup_.camera);
  if (!bent) return nullptr;
  const auto moved = with_value(CameraParameter::kRow, row, **bent);
  return moved ? *moved : nullptr;
}

Result<void> Calibrator::pass() {
  passes_.clear();
  CameraSetup setup = setup_;
  setup.camera = camera_;
  for (const CalibrationDrive& drive : drives_) {
    auto pass = run_pass(drive, setup, odometry_, options_);
    if (!pass) return Error{pass.error().code, fmt::format("{}: {}", drive.name, pass.error().message)};
    passes_.push_back(std::move(*pass));
  }
  if (const auto slope = combined_slope(passes_)) slopes_.push_back({present(kRadial), *slope});
  return {};
}

/// Drives that have too few tracks take no part where others have enough.
Result<std::vector<BatchResult>> Calibrator::adjust(const std::vector<FreeParameter>& free) const {
  std::vector<BatchResult> results;
  std::optional<Error> failed;
  for (const Pass& pass : passes_) {
    auto result = adjust_batch(pass.tracks, camera_, free, options_.batch);
    if (result) results.push_back(std::move(*result));
    if (!result) failed = result.error();
  }
  if (results.empty() && failed) return *failed;
  return results;
}

/// Odometry and batch adjustment in turn, until the camera stays as it is.
Result<void> Calibrator::find_by_tracks() {
  for (int round = 0; round < options_.max_rounds; ++round) {
    const auto results = adjust(kBoth);
    if (!results) return results.error();
    by_tracks_ = combined(*results);
    const CameraPtr next = camera_with(by_tracks_.values(kRadial), by_tracks_.values(kRow));
    if (!next) return Error{ErrorCode::kNotConverged, "the tracks ask for a camera that can't be"};
    const double moved_px = std::max(std::abs(by_tracks_.values(kRadial) - present(kRadial)) / steps_[kRadial],
                                     std::abs(by_tracks_.values(kRow) - present(kRow)) / steps_[kRow]);
    if (moved_px < options_.settled_px) break;
    camera_ = next;
    if (const auto done = pass(); !done) return done;
  }
  return {};
}

/// Where the slope vanishes, by the two passes that tell most about how it depends on the radial coefficient.
void Calibrator::find_by_slope() {
  if (slopes_.size() < 2) return;
  const SlopeAt& last = slopes_.back();
  const SlopeAt* other = nullptr;
  for (const SlopeAt& slope : slopes_) {
    if (other == nullptr || std::abs(slope.radial - last.radial) > std::abs(other->radial - last.radial))
      other = &slope;
  }
  const double apart = other->radial - last.radial;
  constexpr double kLeastPx = 1.0;
  if (std::abs(apart) < kLeastPx * steps_[kRadial]) return;
  const double sensitivity = (other->slope.per_100m - last.slope.per_100m) / apart;
  const double noise = std::hypot(other->slope.sd_per_100m, last.slope.sd_per_100m, options_.slope_model);
  // A secant within its own noise points anywhere.
  if (std::abs(other->slope.per_100m - last.slope.per_100m) < 3.0 * noise) return;
  by_slope_ = ParameterEstimate{last.radial - last.slope.per_100m / sensitivity,
                                std::hypot(last.slope.sd_per_100m, options_.slope_model) / std::abs(sensitivity)};
}

/// Sandwich, halves of the tracks and of the drive, and the tracker's part.
Result<void> Calibrator::state_uncertainty() {
  const double model_px[] = {options_.radial_model_px, options_.row_model_px};
  Eigen::Vector2d squares = by_tracks_.covariance.diagonal();
  Eigen::Vector2d worst = Eigen::Vector2d::Zero();
  for (const bool by_time : {false, true}) {
    std::vector<BatchResult> halves[2];
    for (const Pass& pass : passes_) {
      const auto views = static_cast<int>(pass.tracks.views.size());
      for (const int half : {0, 1}) {
        const auto keep = [by_time, half, views](const DriveTracks::Track& track) {
          if (!by_time) return track.id % 2 == half;
          return (track.sights[track.sights.size() / 2].view < views / 2) == (half == 0);
        };
        auto result = adjust_batch(tracks_of(pass.tracks, keep), camera_, kBoth, options_.batch);
        if (result) halves[half].push_back(std::move(*result));
      }
    }
    if (halves[0].empty() || halves[1].empty()) continue;
    const Combined first = combined(halves[0]);
    const Combined second = combined(halves[1]);
    for (const std::size_t j : {kRadial, kRow}) {
      const auto index = static_cast<Eigen::Index>(j);
      const double apart = first.values(index) - second.values(index);
      const double model = model_px[j] * steps_[j];
      const double sd =
          std::sqrt(first.covariance(index, index) + second.covariance(index, index) + 2.0 * model * model);
      worst(index) = std::max(worst(index), std::abs(apart) / sd);
      // Of two halves the mean has a quarter of the difference's variance. Of halves by time one may hold no turn:
      // their difference then says nothing about the whole.
      if (!by_time) squares(index) += 0.25 * apart * apart;
    }
  }
  for (const std::size_t j : {kRadial, kRow}) {
    const auto index = static_cast<Eigen::Index>(j);
    sds_.push_back(std::hypot(std::sqrt(squares(index)), model_px[j] * steps_[j]));
    disagree_.push_back(worst(index) > options_.max_disagreement
                            ? fmt::format("halves of the data are {:.1f} standard deviations apart", worst(index))
                            : std::string());
  }
  return {};
}

/// @return Why parameter j stays as it was; empty where it may change.
std::string Calibrator::why_refused(std::size_t j) const {
  if (!disagree_[j].empty()) return disagree_[j];
  const double change_px = std::abs(by_tracks_.values(static_cast<Eigen::Index>(j)) - start_[j]) / steps_[j];
  if (change_px > options_.max_change_px) {
    return fmt::format("it would change by {:.0f} px in the image's corners: the start is too far off", change_px);
  }
  if (j == kRadial && by_slope_) {
    const double apart = std::abs(by_slope_->value - by_tracks_.values(kRadial)) / std::hypot(by_slope_->sd, sds_[j]);
    if (apart > options_.max_disagreement) {
      return fmt::format("tracks and drift of the scale contradict each other by {:.1f} standard deviations", apart);
    }
  }
  return "";
}

/// The values that come out, each with its reason.
Result<void> Calibrator::take_over() {
  double values[] = {by_tracks_.values(kRadial), by_tracks_.values(kRow)};
  double sds[] = {sds_[kRadial], sds_[kRow]};
  if (by_slope_) {
    const double tracks = 1.0 / (sds[kRadial] * sds[kRadial]);
    const double slope = 1.0 / (by_slope_->sd * by_slope_->sd);
    values[kRadial] = (tracks * values[kRadial] + slope * by_slope_->value) / (tracks + slope);
    sds[kRadial] = 1.0 / std::sqrt(tracks + slope);
  }
  for (const std::size_t j : {kRadial, kRow}) {
    CalibratedParameter parameter{kParameters[j], start_[j], values[j], sds[j], why_refused(j)};
    if (!parameter.reason.empty()) {
      parameter.after = parameter.before;
      parameter.sd = 0.0;
    }
    calibration_.parameters.push_back(parameter);
  }
  CalibratedParameter& row = calibration_.parameters[kRow];
  const double radial = calibration_.parameters[kRadial].after;
  if (row.reason.empty()) {
    // The row that belongs to the coefficient taken.
    const CameraPtr bent = camera_with(radial, row.after);
    if (!bent) return Error{ErrorCode::kNotConverged, "the drift of the scale asks for a camera that can't be"};
    camera_ = bent;
    const auto results = adjust({{CameraParameter::kRow}});
    if (!results) return results.error();
    double information = 0.0;
    double weighted = 0.0;
    for (const BatchResult& result : *results) {
      information += 1.0 / result.covariance(0, 0);
      weighted += result.values[0] / result.covariance(0, 0);
    }
    row.after = weighted / information;
  }
  camera_ = camera_with(radial, row.after);
  if (!camera_) return Error{ErrorCode::kNotConverged, "what comes out is no camera"};
  return {};
}

/// Held-out tracks with the poses that belong to each camera, and the slope with the new one.
Result<void> Calibrator::check(Calibration& result) {
  const CameraPtr found = camera_;
  double squares[2] = {0.0, 0.0};
  for (const int which : {0, 1}) {
    const CameraPtr camera = which == 0 ? setup_.camera : found;
    for (const Pass& pass : passes_) {
      // Poses alone: the parameter that an adjustment needs is held where it is.
      const std::vector<FreeParameter> held = {{CameraParameter::kRadial, 1e-6 * steps_[kRadial]}};
      const auto poses = adjust_batch(tracks_of(pass.tracks, takes_part), camera, held, options_.batch);
      if (!poses) continue;
      const double rms_px = reprojection_rms_px(tracks_of(pass.tracks, std::not_fn(takes_part)), poses->cam_from_world,
                                                *camera, options_.batch);
      if (std::isfinite(rms_px)) squares[which] += rms_px * rms_px / static_cast<double>(passes_.size());
    }
  }
  result.held_out_before_px = std::sqrt(squares[0]);
  result.held_out_after_px = std::sqrt(squares[1]);
  camera_ = found;
  if (const auto done = pass(); !done) return done;
  result.slope_after = combined_slope(passes_);
  return {};
}

std::string verdict_of(const Calibration& calibration, const CalibrateOptions& options) {
  const bool any = std::any_of(calibration.parameters.begin(), calibration.parameters.end(),
                               [](const CalibratedParameter& parameter) { return parameter.reason.empty(); });
  if (!any) return "nothing could be found that is surer than the calibration given";
  if (!(calibration.held_out_after_px < calibration.held_out_before_px)) {
    return fmt::format("tracks that took no part fit no better ({:.3f} px before, {:.3f} px after)",
                       calibration.held_out_before_px, calibration.held_out_after_px);
  }
  if (calibration.slope_after &&
      std::abs(calibration.slope_after->per_100m) > options.max_slope + 2.0 * calibration.slope_after->sd_per_100m) {
    return fmt::format("the scale still runs away by {:+.1f} % per 100 m", 100.0 * calibration.slope_after->per_100m);
  }
  return "";
}

Result<Calibration> Calibrator::work() {
  const auto begin = std::chrono::steady_clock::now();
  if (const auto done = pass(); !done) return done.error();
  calibration_.odometry_s = seconds_since(begin);
  calibration_.camera = setup_.camera;
  calibration_.slope_before = combined_slope(passes_);
  for (const Pass& pass : passes_) {
    calibration_.turned_deg += pass.turned_deg;
    calibration_.length_m += pass.length_m;
    calibration_.frames += pass.frames;
  }
  const auto stay = [this, begin](std::string why) {
    calibration_.verdict = "the calibration stays as it is: " + std::move(why);
    calibration_.total_s = seconds_since(begin);
    return calibration_;
  };
  if (calibration_.turned_deg < options_.min_turn_deg) {
    const std::string why = fmt::format("{:.0f} degrees of turning are too little, {:.0f} are needed",
                                        calibration_.turned_deg, options_.min_turn_deg);
    for (const std::size_t j : {kRadial, kRow}) {
      calibration_.parameters.push_back({kParameters[j], start_[j], start_[j], 0.0, why});
    }
    return stay(why);
  }
  if (const auto done = find_by_tracks(); !done) return done.error();
  find_by_slope();
  if (const auto done = state_uncertainty(); !done) return done.error();
  calibration_.radial_by_tracks = {by_tracks_.values(kRadial), sds_[kRadial]};
  calibration_.radial_by_slope = by_slope_;
  if (const auto done = take_over(); !done) return done.error();
  if (const auto done = check(calibration_); !done) return done.error();
  if (const std::string why = verdict_of(calibration_, options_); !why.empty()) return stay(why);
  calibration_.adopted = true;
  calibration_.camera = camera_;
  calibration_.verdict = "calibrated";
  calibration_.total_s = seconds_since(begin);
  return calibration_;
}

}  // namespace

void visit_fields(CalibrateOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "max_rounds", .unit = "", .help = "of odometry and adjustment", .min = 1, .max = 20},
                options.max_rounds);
  visitor.field({.key = "settled_px",
                 .unit = "px",
                 .help = "the rounds end where the camera changes by less in the corners",
                 .min = 0.001,
                 .max = 10},
                options.settled_px);
  visitor.field({.key = "min_turn_deg",
                 .unit = "deg",
                 .help = "turning of all drives together, with less nothing is changed",
                 .min = 0,
                 .max = 10000},
                options.min_turn_deg);
  visitor.field({.key = "max_change_px",
                 .unit = "px",
                 .help = "in the corners, beyond which a parameter is at its bound",
                 .min = 1,
                 .max = 1000},
                options.max_change_px);
  visitor.field({.key = "radial_model_px",
                 .unit = "px",
                 .help = "sd in the corners of what the tracker does to the radial coefficient",
                 .min = 0,
                 .max = 100},
                options.radial_model_px);
  visitor.field({.key = "row_model_px",
                 .unit = "px",
                 .help = "sd of what the tracker does to the principal point's row",
                 .min = 0,
                 .max = 100},
                options.row_model_px);
  visitor.field(
      {.key = "slope_model", .unit = "1/100 m", .help = "sd of the scale's slope that roads add", .min = 0, .max = 1},
      options.slope_model);
  visitor.field({.key = "max_slope",
                 .unit = "1/100 m",
                 .help = "of the scale with the new camera, above it is not taken over",
                 .min = 0,
                 .max = 1},
                options.max_slope);
  visitor.field({.key = "max_disagreement",
                 .unit = "sd",
                 .help = "between halves and between the two ways, above a parameter stays",
                 .min = 1,
                 .max = 100},
                options.max_disagreement);
  visitor.group("views", options.views);
  visitor.group("batch", options.batch);
}

Result<Calibration> calibrate(const std::vector<CalibrationDrive>& drives, const CameraSetup& setup,
                              const OdometryOptions& odometry, const CalibrateOptions& options) {
  GS_CHECK(!drives.empty(), "a drive to calibrate from");
  return Calibrator(drives, setup, odometry, options).work();
}

}  // namespace groundscale
