#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "groundscale/camera/mounting.hpp"
#include "groundscale/estimation/kalman.hpp"
#include "groundscale/scale/filters_internal.hpp"

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// The paper's filter: state (n, h) with h in units of the present step, n <- R n, h <- h + (R n) . t, |t| = 1;
/// observed (n_x, n_z, h); n is made a unit vector again after each update. Constant speed is built in.
/// Diagonal noise, as there. Where only the scale is filtered, as there for triangulation and decomposition, h alone is
/// observed and n follows the camera's rotation and the measurements as they come. (F and H as printed there are a
/// transpose and an index off, see docs/method.md.)
class PaperFilter final : public GroundFilter {
 public:
  PaperFilter(const GroundFilterOptions& options, double camera_height_m)
      : options_(options), camera_height_m_(camera_height_m) {}

  void start(const GroundObservation& observation) override {
    const Eigen::Vector3d normal = Mounting{observation.pitch_rad, observation.roll_rad, 0.0}.normal_in_cam();
    state_.mean << normal, height_in_steps(observation);
    const double angle = std::pow(options_.deviation_deg * kDegree, 2);
    constexpr double kStartSd = 0.3;
    state_.covariance.setZero();
    state_.covariance.diagonal() << angle, angle, angle, std::pow(kStartSd * state_.mean(3), 2);
    step_time_s_ = observation.step_time_s;
    if (!started_) mean_normal_ = normal;
    started_ = true;
    predicted_ = state_;
    transition_.setIdentity();
    update(observation);
  }

  void predict(const GroundStep& step) override {
    if (!started_) return;
    transition_.setZero();
    transition_.topLeftCorner<3, 3>() = step.rotation;
    // h + (R n) . t: the last row is (R^T t, 1), times the change of the unit where frames aren't evenly spaced.
    const double unit = step.dt_s > 0.0 ? step_time_s_ / step.dt_s : 1.0;
    transition_.block<1, 3>(3, 0) = unit * (step.rotation.transpose() * step.direction).transpose();
    transition_(3, 3) = unit;
    if (step.dt_s > 0.0) step_time_s_ = step.dt_s;
    const GaussMarkov deviation{options_.deviation_deg * kDegree, options_.deviation_time_s};
    const double angle = deviation.noise_variance(step.dt_s);
    constexpr double kMinSpeed = 0.5;
    const double speed = std::max(kMinSpeed, speed_of(state_));
    Eigen::Matrix4d noise = Eigen::Matrix4d::Zero();
    noise.diagonal() << angle, angle, angle,
        std::pow(options_.acceleration_mps2 * step.dt_s / speed * state_.mean(3), 2);
    predicted_ = groundscale::predict(state_, transition_, noise);
    keep_valid(predicted_);
    state_ = predicted_;
  }

  void stand(double dt_s) override {
    if (!started_) return;
    step_time_s_ = dt_s;
    constexpr double kCreepMps = 0.3;
    transition_.setIdentity();
    transition_(3, 3) = 0.0;
    predicted_ = state_;
    predicted_.mean(3) = camera_height_m_ / (kCreepMps * dt_s);
    predicted_.covariance.row(3).setZero();
    predicted_.covariance.col(3).setZero();
    predicted_.covariance(3, 3) = std::pow(predicted_.mean(3), 2);
    state_ = predicted_;
  }

  void update(const GroundObservation& observation) override {
    const Eigen::Vector3d normal = Mounting{observation.pitch_rad, observation.roll_rad, 0.0}.normal_in_cam();
    const double height = height_in_steps(observation);
    if (options_.kind == FilterKind::kPaperScale) {
      state_.mean.head<3>() = normal;
      state_.covariance.topRows<3>().setZero();
      state_.covariance.leftCols<3>().setZero();
      observe_height(height,
                     options_.formal_variance_factor * observation.covariance(2, 2) + std::pow(options_.step_model, 2));
    } else {
      observe_plane(normal, height, observation);
    }
    keep_valid(state_);
    constexpr double kMeanGain = 0.02;
    mean_normal_ = (mean_normal_ + kMeanGain * (normal - mean_normal_)).normalized();
  }

  void update_speed(double speed_mps, double log_sd) override {
    if (!started_) return;
    const double height = camera_height_m_ / (speed_mps * step_time_s_);
    observe_height(height, log_sd * log_sd);
    keep_valid(state_);
  }

  void reopen() override {
    if (!started_) return;
    constexpr double kOpenSd = 0.5;
    state_.covariance(3, 3) += std::pow(kOpenSd * state_.mean(3), 2);
  }

  bool started() const override { return started_; }
  GroundState state() const override { return public_form(state_, mean_normal_, step_time_s_); }

  int keep() override {
    kept_.push_back({transition_, predicted_, state_, mean_normal_, step_time_s_, started_});
    transition_.setIdentity();
    predicted_ = state_;
    return static_cast<int>(kept_.size()) - 1;
  }

  std::vector<GroundState> smoothed() const override {
    std::vector<GroundState> states(kept_.size());
    Gaussian<4> later;
    for (std::size_t k = kept_.size(); k-- > 0;) {
      const bool last = k + 1 == kept_.size();
      const bool chained = !last && kept_[k].started;
      later = chained ? smooth<4>(kept_[k].filtered, kept_[k + 1].predicted, later, kept_[k + 1].transition)
                      : kept_[k].filtered;
      states[k] = public_form(later, kept_[k].mean_normal, kept_[k].step_time_s);
    }
    return states;
  }

 private:
  struct Kept {
    Eigen::Matrix4d transition;
    Gaussian<4> predicted, filtered;
    Eigen::Vector3d mean_normal;
    double step_time_s;
    bool started;
  };

  void observe_plane(const Eigen::Vector3d& normal, double height, const GroundObservation& observation) {
    Eigen::Matrix<double, 3, 4> by_state = Eigen::Matrix<double, 3, 4>::Zero();
    by_state(0, 0) = by_state(1, 2) = by_state(2, 3) = 1.0;
    const Eigen::Vector3d residual(normal.x() - state_.mean(0), normal.z() - state_.mean(2), height - state_.mean(3));
    // Diagonal, as in the paper, of the size that the model filter uses.
    Eigen::Vector3d variance = options_.formal_variance_factor * observation.covariance.diagonal();
    variance += Eigen::Vector3d(std::pow(options_.angle_model_deg * kDegree, 2),
                                std::pow(options_.angle_model_deg * kDegree, 2), std::pow(options_.step_model, 2));
    const Eigen::Matrix3d noise = Eigen::Vector3d(variance(1), variance(0), variance(2) * height * height).asDiagonal();
    state_ = groundscale::update<4, 3>(state_, by_state, residual, noise);
  }

  /// @param log_variance  Of log height.
  void observe_height(double height, double log_variance) {
    Eigen::Matrix<double, 1, 4> by_state = Eigen::Matrix<double, 1, 4>::Zero();
    by_state(3) = 1.0;
    const Eigen::Matrix<double, 1, 1> residual(height - state_.mean(3));
    const Eigen::Matrix<double, 1, 1> noise(log_variance * height * height);
    state_ = groundscale::update<4, 1>(state_, by_state, residual, noise);
  }

  double height_in_steps(const GroundObservation& observation) const {
    return camera_height_m_ / std::max(1e-3, std::exp(observation.log_distance) - observation.lead_m);
  }
  double speed_of(const Gaussian<4>& state) const { return camera_height_m_ / (state.mean(3) * step_time_s_); }

  /// A unit normal, and a height that stays above zero.
  static void keep_valid(Gaussian<4>& state) {
    state.mean.head<3>().normalize();
    constexpr double kMinHeight = 1e-3;
    state.mean(3) = std::max(kMinHeight, state.mean(3));
  }

  GroundState public_form(const Gaussian<4>& state, const Eigen::Vector3d& mean_normal, double step_time_s) const {
    const PlaneAngles now = plane_angles(state.mean.head<3>().normalized());
    const PlaneAngles mean = plane_angles(mean_normal);
    return {.pitch_rad = now.pitch_rad,
            .roll_rad = now.roll_rad,
            .mean_pitch_rad = mean.pitch_rad,
            .mean_roll_rad = mean.roll_rad,
            .speed_mps = camera_height_m_ / (std::max(1e-3, state.mean(3)) * step_time_s),
            .log_speed_sd = std::sqrt(std::max(0.0, state.covariance(3, 3))) / std::max(1e-3, state.mean(3))};
  }

  GroundFilterOptions options_;
  double camera_height_m_;
  bool started_ = false;
  double step_time_s_ = 0.1;
  Gaussian<4> state_, predicted_;
  Eigen::Vector3d mean_normal_ = Eigen::Vector3d::UnitY();
  Eigen::Matrix4d transition_ = Eigen::Matrix4d::Identity();
  std::vector<Kept> kept_;
};

}  // namespace

std::unique_ptr<GroundFilter> make_paper_filter(const GroundFilterOptions& options, double camera_height_m) {
  return std::make_unique<PaperFilter>(options, camera_height_m);
}

}  // namespace groundscale
