#include "groundscale/calibration/calibrate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <Eigen/LU>
#include <fmt/format.h>

#include "groundscale/core/check.hpp"
#include "groundscale/odometry/turning.hpp"

namespace groundscale {
namespace {

/// Places of the two that are always free; the others follow.
constexpr Eigen::Index kRadial = 0;
constexpr Eigen::Index kRow = 1;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Two independent statements about a number.
ParameterEstimate combined(const ParameterEstimate& a, const ParameterEstimate& b) {
  const double weight_a = 1.0 / (a.sd * a.sd);
  const double weight_b = 1.0 / (b.sd * b.sd);
  return {(weight_a * a.value + weight_b * b.value) / (weight_a + weight_b), 1.0 / std::sqrt(weight_a + weight_b)};
}

/// Estimates of several drives by their covariances.
struct Combined {
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
};

Combined combined(const std::vector<BatchResult>& results) {
  const auto size = results.front().covariance.rows();
  if (results.size() == 1) {
    return {Eigen::Map<const Eigen::VectorXd>(results.front().values.data(), size), results.front().covariance};
  }
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd weighted = Eigen::VectorXd::Zero(size);
  for (const BatchResult& result : results) {
    // A drive of few blocks has a sandwich that is sure of some direction for no reason.
    const Eigen::MatrixXd own = (result.covariance + result.formal_covariance).inverse();
    information += own;
    weighted += own * Eigen::Map<const Eigen::VectorXd>(result.values.data(), size);
  }
  const Eigen::MatrixXd covariance = information.inverse();
  return {covariance * weighted, covariance};
}

/// Of those that have one.
std::optional<ScaleSlope> slope_of_all(const std::vector<DrivePass>& passes) {
  std::vector<ScaleSlope> lines;
  for (const DrivePass& pass : passes) {
    if (pass.slope) lines.push_back(*pass.slope);
  }
  return combined_slope(std::move(lines));
}

std::vector<std::optional<ScaleSlope>> slopes_of(const std::vector<DrivePass>& passes) {
  std::vector<std::optional<ScaleSlope>> slopes;
  for (const DrivePass& pass : passes) slopes.push_back(pass.slope);
  return slopes;
}

/// The work of one calibration.
class Calibrator {
 public:
  Calibrator(const std::vector<CalibrationDrive>& drives, const CameraSetup& setup, const OdometryOptions& odometry,
             const CalibrateOptions& options, const CalibrateProgress& progress);

  Result<Calibration> work();

 private:
  struct SlopeAt {
    double radial = 0.0;
    ScaleSlope slope;
  };
  /// A parameter that may change.
  struct Freed {
    CameraParameter parameter = CameraParameter::kRadial;
    double start = 0.0;
    double step = 1.0;               ///< That moves pixels far out by one.
    double model = 0.0;              ///< Sd that the tracker adds.
    std::optional<double> prior_sd;  ///< Of the start.
  };
  void free(CameraParameter parameter, double model);

  void say(const std::string& what, int frames = 0) const {
    if (progress_) progress_(what, frames);
  }
  /// A pass over all drives with the present camera.
  Result<void> pass();
  Result<std::vector<BatchResult>> adjust(const std::vector<FreeParameter>& free);
  Result<void> fix_by_priors();
  Result<void> find_by_tracks();
  void find_by_slope();
  void state_uncertainty();
  double model_of(std::size_t j, double share) const;
  std::string why_refused(std::size_t j) const;
  Result<void> take_over();
  Result<void> adjust_row();
  CameraPtr camera_without_held_out();
  Result<void> check();
  Result<void> find_and_check();
  std::string why_not_adopted() const;
  Calibration stay(std::string why);
  CameraPtr camera_with(const Eigen::VectorXd& values) const;
  Eigen::VectorXd values_found() const;  ///< Of the parameters, as they come out.
  double present(std::size_t j) const { return value_of(freed_[j].parameter, *camera_); }

  const std::vector<CalibrationDrive>& drives_;
  CameraSetup setup_;
  const OdometryOptions& odometry_;
  const CalibrateOptions& options_;
  const CalibrateProgress& progress_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  CameraPtr camera_;
  std::vector<Freed> freed_;
  std::vector<FreeParameter> all_;  ///< The same for the adjustment.
  std::vector<DrivePass> passes_;   ///< With the present camera,
  std::vector<DrivePass> first_;    ///< and with the first one.
  std::vector<SlopeAt> slopes_;
  Combined by_tracks_;
  std::vector<double> sds_;            ///< Of by_tracks_.
  std::vector<std::string> disagree_;  ///< Which halves do, and by how much.
  std::optional<ParameterEstimate> by_slope_;
  Calibration calibration_;
};

Calibrator::Calibrator(const std::vector<CalibrationDrive>& drives, const CameraSetup& setup,
                       const OdometryOptions& odometry, const CalibrateOptions& options,
                       const CalibrateProgress& progress)
    : drives_(drives),
      setup_(setup),
      odometry_(odometry),
      options_(options),
      progress_(progress),
      camera_(setup.camera) {
  free(CameraParameter::kRadial, options.radial_model_px * pixel_step(CameraParameter::kRadial, *camera_));
  free(CameraParameter::kRow, options.row_model_px);
  const auto& sds = setup.parameter_sds;
  if (options.free_focal || sds.contains(CameraParameter::kFocal)) {
    free(CameraParameter::kFocal, options.focal_model * camera_->focal_px());
  }
  if (sds.contains(CameraParameter::kColumn)) free(CameraParameter::kColumn, options.column_model_px);
}

void Calibrator::free(CameraParameter parameter, double model) {
  Freed freed{parameter, value_of(parameter, *camera_), pixel_step(parameter, *camera_), model, std::nullopt};
  const auto sd = setup_.parameter_sds.find(parameter);
  if (sd != setup_.parameter_sds.end()) freed.prior_sd = sd->second;
  freed_.push_back(freed);
  all_.push_back({parameter});
}

/// Null where there is no such camera.
CameraPtr Calibrator::camera_with(const Eigen::VectorXd& values) const {
  CameraPtr camera = setup_.camera;
  for (std::size_t j = 0; j < freed_.size(); ++j) {
    const auto next = with_value(freed_[j].parameter, values(static_cast<Eigen::Index>(j)), *camera);
    if (!next) return nullptr;
    camera = *next;
  }
  return camera;
}

Eigen::VectorXd Calibrator::values_found() const {
  Eigen::VectorXd values(static_cast<Eigen::Index>(freed_.size()));
  for (std::size_t j = 0; j < freed_.size(); ++j) {
    values(static_cast<Eigen::Index>(j)) = calibration_.parameters[j].after;
  }
  return values;
}

Result<void> Calibrator::pass() {
  passes_.clear();
  CameraSetup setup = setup_;
  setup.camera = camera_;
  ++calibration_.passes;
  int done = 0;
  for (const CalibrationDrive& drive : drives_) {
    auto pass = drive_pass(drive, setup, odometry_, options_.views, [this, done](int frames) {
      say(fmt::format("odometry, pass {}", calibration_.passes), done + frames);
    });
    if (!pass) return Error{pass.error().code, fmt::format("{}: {}", drive.name, pass.error().message)};
    done += pass->frames;
    passes_.push_back(std::move(*pass));
  }
  if (const auto slope = slope_of_all(passes_)) slopes_.push_back({present(kRadial), *slope});
  return {};
}

/// Drives that have too few tracks take no part where others have enough.
Result<std::vector<BatchResult>> Calibrator::adjust(const std::vector<FreeParameter>& free) {
  std::vector<BatchResult> results;
  std::optional<Error> failed;
  for (DrivePass& pass : passes_) {
    auto result = adjust_batch(pass.tracks, camera_, free, options_.batch);
    if (!result) {
      failed = result.error();
      continue;
    }
    // What is adjusted next begins nearer to its end.
    for (std::size_t view = 0; view < pass.tracks.views.size(); ++view) {
      pass.tracks.views[view].cam_from_world = result->cam_from_world[view];
    }
    results.push_back(std::move(*result));
  }
  if (results.empty()) return *failed;
  return results;
}

/// Focal length and column where something is known of them: what the tracks say counts by the tracker's part, not by
/// their covariance, and the other two are adjusted again with what comes out.
Result<void> Calibrator::fix_by_priors() {
  Eigen::VectorXd values = by_tracks_.values;
  bool any = false;
  for (std::size_t j = kRow + 1; j < freed_.size(); ++j) {
    const auto index = static_cast<Eigen::Index>(j);
    const Freed& freed = freed_[j];
    if (!freed.prior_sd) continue;
    const double sd = std::hypot(std::sqrt(by_tracks_.covariance(index, index)), freed.model);
    values(index) = combined({values(index), sd}, {freed.start, *freed.prior_sd}).value;
    any = true;
  }
  if (!any) return {};
  const CameraPtr before = camera_;
  camera_ = camera_with(values);
  const auto results = camera_ == nullptr
                           ? Result<std::vector<BatchResult>>(Error{ErrorCode::kNotConverged, "no camera"})
                           : adjust({all_[kRadial], all_[kRow]});
  camera_ = before;
  if (!results) return results.error();
  const Combined two = combined(*results);
  values.head<2>() = two.values;
  by_tracks_.values = values;
  by_tracks_.covariance.topLeftCorner<2, 2>() = two.covariance;
  return {};
}

/// Odometry and batch adjustment in turn, until the camera stays as it is.
Result<void> Calibrator::find_by_tracks() {
  for (int round = 0;; ++round) {
    say("adjusting the whole drive");
    const auto results = adjust(all_);
    if (!results) return results.error();
    by_tracks_ = combined(*results);
    if (const auto done = fix_by_priors(); !done) return done;
    const CameraPtr next = camera_with(by_tracks_.values);
    if (!next) return Error{ErrorCode::kNotConverged, "the tracks ask for a camera that can't be"};
    double moved_px = 0.0;
    for (std::size_t j = 0; j < freed_.size(); ++j) {
      const double moved = by_tracks_.values(static_cast<Eigen::Index>(j)) - present(j);
      moved_px = std::max(moved_px, std::abs(moved) / freed_[j].step);
    }
    camera_ = next;
    if (moved_px < options_.settled_px || round == options_.max_rounds) return {};
    if (const auto done = pass(); !done) return done;
  }
}

/// Where the slope vanishes, by the two passes that tell most about how it depends on the radial coefficient, and by
/// what is known of that beforehand.
void Calibrator::find_by_slope() {
  if (slopes_.empty()) return;
  const SlopeAt& last = slopes_.back();
  const double step = freed_[kRadial].step;
  ParameterEstimate sensitivity{options_.sensitivity / step, options_.sensitivity_sd / step};
  const auto other = std::max_element(slopes_.begin(), slopes_.end(), [&last](const SlopeAt& a, const SlopeAt& b) {
    return std::abs(a.radial - last.radial) < std::abs(b.radial - last.radial);
  });
  const double apart = other->radial - last.radial;
  if (std::abs(apart) > 0.0) {
    // The tracks creep in both alike.
    const double noise = std::hypot(other->slope.sd_per_100m, last.slope.sd_per_100m, options_.slope_model);
    sensitivity =
        combined(sensitivity, {(other->slope.per_100m - last.slope.per_100m) / apart, noise / std::abs(apart)});
  }
  // A secant within its own noise points anywhere.
  if (!(sensitivity.value < -2.0 * sensitivity.sd))
    sensitivity = {options_.sensitivity / step, options_.sensitivity_sd / step};
  const double change = -last.slope.per_100m / sensitivity.value;
  const double slope_sd =
      std::hypot(last.slope.sd_per_100m, options_.slope_model, options_.slip_px / camera_->focal_px());
  by_slope_ =
      ParameterEstimate{last.radial + change, std::hypot(slope_sd, change * sensitivity.sd) / -sensitivity.value};
}

/// The tracks of one half: those with even ids, or those of the first half of the views.
DriveTracks half_of(const DriveTracks& drive, bool by_time, int half) {
  const auto middle = static_cast<int>(drive.views.size()) / 2;
  return tracks_of(drive, [by_time, half, middle](const DriveTracks::Track& track) {
    if (!by_time) return track.id % 2 == half;
    return (track.sights[track.sights.size() / 2].view < middle) == (half == 0);
  });
}

/// Whether both halves of a drive's views turn enough to say something.
bool turns_in_halves(const DrivePass& pass, double min_turn_deg) {
  std::vector<RigidTransform> poses;
  for (const DriveTracks::View& view : pass.tracks.views) poses.push_back(view.cam_from_world.inverse());
  const auto middle = static_cast<std::ptrdiff_t>(poses.size() / 2);
  return turned_deg({poses.begin(), poses.begin() + middle}) >= min_turn_deg &&
         turned_deg({poses.begin() + middle, poses.end()}) >= min_turn_deg;
}

/// Sd that tracker and too little turning add to a parameter.
/// @param share  Of all turning.
double Calibrator::model_of(std::size_t j, double share) const {
  const Freed& freed = freed_[j];
  const double turned_deg = std::max(1.0, share * calibration_.turned_deg);
  return std::hypot(freed.model, freed.step * options_.turn_px / std::sqrt(turned_deg));
}

/// Sandwich, halves of the tracks and of the drive, and the tracker's part.
void Calibrator::state_uncertainty() {
  say("halves of the tracks and of the drive");
  const auto size = static_cast<Eigen::Index>(freed_.size());
  Eigen::VectorXd squares = by_tracks_.covariance.diagonal();
  Eigen::VectorXd worst = Eigen::VectorXd::Zero(size);
  for (const bool by_time : {false, true}) {
    std::vector<BatchResult> halves[2];
    for (const DrivePass& pass : passes_) {
      if (by_time && !turns_in_halves(pass, options_.min_turn_deg)) continue;
      for (const int half : {0, 1}) {
        auto result = adjust_batch(half_of(pass.tracks, by_time, half), camera_, all_, options_.batch);
        if (result) halves[half].push_back(std::move(*result));
      }
    }
    if (halves[0].empty() || halves[1].empty()) continue;
    const Combined first = combined(halves[0]);
    const Combined second = combined(halves[1]);
    for (Eigen::Index j = 0; j < size; ++j) {
      const double apart = first.values(j) - second.values(j);
      const double model = model_of(static_cast<std::size_t>(j), by_time ? 0.5 : 1.0);
      const double sd = std::sqrt(first.covariance(j, j) + second.covariance(j, j) + 2.0 * model * model);
      worst(j) = std::max(worst(j), std::abs(apart) / sd);
      // Of two halves the mean has a quarter of the difference's variance.
      squares(j) = std::max(squares(j), by_tracks_.covariance(j, j) + 0.25 * apart * apart);
    }
  }
  for (Eigen::Index j = 0; j < size; ++j) {
    sds_.push_back(std::hypot(std::sqrt(squares(j)), model_of(static_cast<std::size_t>(j), 1.0)));
    disagree_.push_back(worst(j) > options_.max_disagreement
                            ? fmt::format("halves of the data are {:.1f} standard deviations apart", worst(j))
                            : std::string());
  }
}

/// @return Why parameter j stays as it was; empty where it may change.
std::string Calibrator::why_refused(std::size_t j) const {
  if (!disagree_[j].empty()) return disagree_[j];
  const double change_px = std::abs(by_tracks_.values(static_cast<Eigen::Index>(j)) - freed_[j].start) / freed_[j].step;
  // Of a camera without calibration the principal point may be anywhere.
  const double bound_px = options_.free_focal ? 2.0 * options_.max_change_px : options_.max_change_px;
  if (change_px > bound_px) {
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
  for (std::size_t j = 0; j < freed_.size(); ++j) {
    const Freed& freed = freed_[j];
    ParameterEstimate estimate{by_tracks_.values(static_cast<Eigen::Index>(j)), sds_[j]};
    if (j == kRadial && by_slope_) {
      // Where the two differ by more than they should, neither can be trusted as far as it says.
      const double apart = std::abs(by_slope_->value - estimate.value) / std::hypot(by_slope_->sd, estimate.sd);
      estimate = combined(estimate, *by_slope_);
      estimate.sd *= std::max(1.0, apart);
    }
    if (j == kRadial && freed.prior_sd) estimate = combined(estimate, {freed.start, *freed.prior_sd});
    // Focal length and column have had theirs already; of their sd it is still to be told.
    if (j > kRow && freed.prior_sd) estimate.sd = combined(estimate, {freed.start, *freed.prior_sd}).sd;
    CalibratedParameter parameter{freed.parameter, freed.start, estimate.value, estimate.sd, why_refused(j)};
    if (!parameter.reason.empty()) {
      parameter.after = parameter.before;
      parameter.sd = freed.prior_sd.value_or(0.0);
    }
    calibration_.parameters.push_back(parameter);
  }
  if (calibration_.parameters[kRow].reason.empty()) {
    if (const auto done = adjust_row(); !done) return done;
  }
  camera_ = camera_with(values_found());
  if (!camera_) return Error{ErrorCode::kNotConverged, "what comes out is no camera"};
  return {};
}

/// The row that belongs to the coefficient taken.
Result<void> Calibrator::adjust_row() {
  say("adjusting the row");
  CalibratedParameter& row = calibration_.parameters[kRow];
  camera_ = camera_with(values_found());
  if (!camera_) return Error{ErrorCode::kNotConverged, "the drift of the scale asks for a camera that can't be"};
  const auto results = adjust({all_[kRow]});
  if (!results) return results.error();
  ParameterEstimate estimate{combined(*results).values(0), row.sd};
  if (freed_[kRow].prior_sd) estimate = combined(estimate, {row.before, *freed_[kRow].prior_sd});
  row.after = estimate.value;
  row.sd = estimate.sd;
  return {};
}

/// The camera as it comes out where every third track takes no part; null where nothing does.
CameraPtr Calibrator::camera_without_held_out() {
  const CameraPtr found = camera_;
  std::vector<DriveTracks> all;
  for (DrivePass& pass : passes_) all.push_back(std::exchange(pass.tracks, without_held_out(pass.tracks)));
  Eigen::VectorXd values = values_found();
  CameraPtr without;
  if (const auto both = adjust(all_)) {
    const Combined fewer = combined(*both);
    for (std::size_t j = 0; j < freed_.size(); ++j) {
      const auto index = static_cast<Eigen::Index>(j);
      const CalibratedParameter& parameter = calibration_.parameters[j];
      if (!parameter.reason.empty()) continue;
      // By as much as the tracks count in what came out.
      const double weight = std::min(1.0, std::pow(parameter.sd / sds_[j], 2));
      values(index) += weight * (fewer.values(index) - by_tracks_.values(index));
    }
    camera_ = camera_with(values);
    const auto row = camera_ != nullptr && calibration_.parameters[kRow].reason.empty()
                         ? adjust({all_[kRow]})
                         : Result<std::vector<BatchResult>>(Error{});
    if (row && !freed_[kRow].prior_sd) values(kRow) = combined(*row).values(0);
    without = camera_with(values);
  }
  for (std::size_t d = 0; d < passes_.size(); ++d) passes_[d].tracks = std::move(all[d]);
  camera_ = found;
  return without;
}

/// Held-out tracks, and the slope with the new camera.
Result<void> Calibrator::check() {
  say("tracks that took no part");
  const CameraPtr found = camera_without_held_out();
  if (found != nullptr) calibration_.held_out = compare_held_out(passes_, setup_.camera, found, options_.batch);
  if (const auto done = pass(); !done) return done;
  calibration_.slope_after = slope_of_all(passes_);
  calibration_.slopes_after = slopes_of(passes_);
  calibration_.length_change = length_change(first_, passes_);
  return {};
}

std::string Calibrator::why_not_adopted() const {
  const Calibration& found = calibration_;
  const bool any = std::any_of(found.parameters.begin(), found.parameters.end(),
                               [](const CalibratedParameter& parameter) { return parameter.reason.empty(); });
  if (!any) return "nothing could be found that is surer than the calibration given";
  if (!(found.held_out.after_px < found.held_out.before_px)) {
    return fmt::format("tracks that took no part fit no better ({:.4f} px before, {:.4f} px after)",
                       found.held_out.before_px, found.held_out.after_px);
  }
  if (!found.slope_after) return "the ground was seen too rarely with the new camera to check the scale's drift";
  if (found.slope_after->sd_per_100m > options_.max_slope) {
    return fmt::format("the scale's drift with the new camera is known to {:.1f} % per 100 m only",
                       100.0 * found.slope_after->sd_per_100m);
  }
  if (std::abs(found.slope_after->per_100m) > options_.max_slope) {
    return fmt::format("the scale still runs away by {:+.1f} % per 100 m", 100.0 * found.slope_after->per_100m);
  }
  return "";
}

Calibration Calibrator::stay(std::string why) {
  calibration_.verdict = "the calibration stays as it is: " + std::move(why);
  calibration_.total_s = seconds_since(begin_);
  return calibration_;
}

Result<void> Calibrator::find_and_check() {
  if (const auto done = find_by_tracks(); !done) return done;
  find_by_slope();
  state_uncertainty();
  calibration_.radial_by_tracks = {by_tracks_.values(kRadial), sds_[kRadial]};
  calibration_.radial_by_slope = by_slope_;
  if (const auto done = take_over(); !done) return done;
  return check();
}

Result<Calibration> Calibrator::work() {
  if (const auto done = pass(); !done) return done.error();
  first_ = passes_;
  calibration_.odometry_s = seconds_since(begin_);
  calibration_.setup = setup_;
  calibration_.slope_before = slope_of_all(passes_);
  calibration_.slopes_before = slopes_of(passes_);
  for (const DrivePass& pass : passes_) {
    calibration_.turned_deg += pass.turned_deg;
    calibration_.length_m += pass.length_m;
    calibration_.frames += pass.frames;
  }
  if (calibration_.turned_deg < options_.min_turn_deg) {
    const std::string why = fmt::format("{:.0f} degrees of turning are too little, {:.0f} are needed",
                                        calibration_.turned_deg, options_.min_turn_deg);
    for (const Freed& freed : freed_) {
      calibration_.parameters.push_back({freed.parameter, freed.start, freed.start, freed.prior_sd.value_or(0.0), why});
    }
    return stay(why);
  }
  if (const auto done = find_and_check(); !done) {
    // That a drive tells nothing is no failure.
    const ErrorCode code = done.error().code;
    if (code != ErrorCode::kNotConverged && code != ErrorCode::kTooFewMatches) return done.error();
    return stay(done.error().message);
  }
  if (const std::string why = why_not_adopted(); !why.empty()) return stay(why);
  calibration_.adopted = true;
  calibration_.verdict = "calibrated";
  calibration_.setup.camera = camera_;
  for (const CalibratedParameter& parameter : calibration_.parameters) {
    if (parameter.sd > 0.0) calibration_.setup.parameter_sds[parameter.parameter] = parameter.sd;
  }
  // The first drive that tells it: between drives a camera may have been moved.
  const auto told =
      std::find_if(passes_.begin(), passes_.end(), [](const DrivePass& pass) { return pass.mounting.has_value(); });
  if (told != passes_.end()) {
    calibration_.setup.pitch_rad = told->mounting->pitch_rad;
    calibration_.setup.roll_rad = told->mounting->roll_rad;
    calibration_.setup.yaw_rad = told->mounting->yaw_rad;
  }
  calibration_.total_s = seconds_since(begin_);
  return calibration_;
}

}  // namespace

Result<Calibration> calibrate(const std::vector<CalibrationDrive>& drives, const CameraSetup& setup,
                              const OdometryOptions& odometry, const CalibrateOptions& options,
                              const CalibrateProgress& progress) {
  GS_CHECK(!drives.empty(), "a drive to calibrate from");
  return Calibrator(drives, setup, odometry, options, progress).work();
}

}  // namespace groundscale
