#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "groundscale/estimation/kalman.hpp"
#include "groundscale/scale/filters_internal.hpp"

namespace groundscale {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// State: mean pitch and roll (mounting), their deviation (suspension and slope), log speed.
enum Index { kMeanPitch, kMeanRoll, kPitch, kRoll, kLogSpeed };
using State = Gaussian<5>;
using Transition = Eigen::Matrix<double, 5, 5>;

class ModelFilter final : public GroundFilter {
 public:
  explicit ModelFilter(const GroundFilterOptions& options) : options_(options) {}

  void start(const GroundObservation& observation) override {
    if (!started_) {
      state_.mean << observation.pitch_rad, observation.roll_rad, 0.0, 0.0, 0.0;
      state_.covariance.setZero();
      const double deviation = std::pow(options_.deviation_deg * kDegree, 2);
      state_.covariance.diagonal() << deviation, deviation, deviation, deviation, 0.0;
    }
    const double step = std::max(1e-3, std::exp(observation.log_distance) - observation.lead_m);
    state_.mean(kLogSpeed) = std::log(step / observation.step_time_s);
    state_.covariance.row(kLogSpeed).setZero();
    state_.covariance.col(kLogSpeed).setZero();
    constexpr double kStartSd = 0.3;  // of log speed
    state_.covariance(kLogSpeed, kLogSpeed) = kStartSd * kStartSd;
    started_ = true;
    predicted_ = state_;
    transition_.setIdentity();
    update(observation);
  }

  void predict(const GroundStep& step) override {
    if (!started_) return;
    const GaussMarkov deviation{options_.deviation_deg * kDegree, options_.deviation_time_s};
    const double decay = deviation.decay(step.dt_s);
    transition_.setIdentity();
    transition_(kPitch, kPitch) = decay;
    transition_(kRoll, kRoll) = decay;
    Transition noise = Transition::Zero();
    const double mean_noise = std::pow(options_.mean_drift_deg * kDegree, 2) * step.dt_s;
    const double deviation_noise = deviation.noise_variance(step.dt_s);
    const auto [change, change_variance] = speed_change(step);
    noise.diagonal() << mean_noise, mean_noise, deviation_noise, deviation_noise, change_variance;
    predicted_ = groundscale::predict(state_, transition_, noise);
    predicted_.mean(kLogSpeed) += change;
    predicted_.mean(kPitch) += step.pitch_change_rad;
    predicted_.mean(kRoll) += step.roll_change_rad;
    state_ = predicted_;
  }

  void stand(double dt_s) override {
    if (!started_) return;
    predict({.dt_s = dt_s});
    // What the speed was doesn't say how the vehicle will start.
    constexpr double kCreepMps = 0.3;
    constexpr double kSd = 1.0;
    transition_.row(kLogSpeed).setZero();
    predicted_.mean(kLogSpeed) = std::log(kCreepMps);
    predicted_.covariance.row(kLogSpeed).setZero();
    predicted_.covariance.col(kLogSpeed).setZero();
    predicted_.covariance(kLogSpeed, kLogSpeed) = kSd * kSd;
    state_ = predicted_;
  }

  /// Iterated (Bell, Cathey 1993): log(lead + step) is far from linear in log speed where the step is the smaller part,
  /// as when a vehicle sets off, and one linearisation there can end at any multiple of the measured distance.
  void update(const GroundObservation& observation) override {
    const State prior = state_;
    const Eigen::Vector3d measured(observation.pitch_rad, observation.roll_rad, observation.log_distance);
    const double angle_variance = std::pow(options_.angle_model_deg * kDegree, 2);
    Eigen::Matrix3d noise = options_.formal_variance_factor * observation.covariance;
    noise.diagonal() += Eigen::Vector3d(angle_variance, angle_variance, options_.step_model * options_.step_model);
    constexpr int kMaxIterations = 20;
    constexpr double kConverged = 1e-9;
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
      const Eigen::Matrix<double, 5, 1> at = state_.mean;
      const double step = std::exp(at(kLogSpeed)) * observation.step_time_s;
      const double distance = observation.lead_m + step;
      Eigen::Matrix<double, 3, 5> by_state = Eigen::Matrix<double, 3, 5>::Zero();
      by_state(0, kMeanPitch) = by_state(0, kPitch) = 1.0;
      by_state(1, kMeanRoll) = by_state(1, kRoll) = 1.0;
      by_state(2, kLogSpeed) = step / distance;
      const Eigen::Vector3d expected(at(kMeanPitch) + at(kPitch), at(kMeanRoll) + at(kRoll), std::log(distance));
      // Of the prior, by the linearisation here.
      const Eigen::Vector3d residual = measured - expected - by_state * (prior.mean - at);
      state_ = groundscale::update<5, 3>(prior, by_state, residual, noise);
      if ((state_.mean - at).cwiseAbs().maxCoeff() < kConverged) break;
    }
  }

  void update_speed(double speed_mps, double log_sd) override {
    if (!started_) return;
    Eigen::Matrix<double, 1, 5> by_state = Eigen::Matrix<double, 1, 5>::Zero();
    by_state(kLogSpeed) = 1.0;
    const Eigen::Matrix<double, 1, 1> residual(std::log(speed_mps) - state_.mean(kLogSpeed));
    const Eigen::Matrix<double, 1, 1> noise(log_sd * log_sd);
    state_ = groundscale::update<5, 1>(state_, by_state, residual, noise);
  }

  void reopen() override {
    if (!started_) return;
    constexpr double kOpenSd = 0.5;
    state_.covariance(kLogSpeed, kLogSpeed) += kOpenSd * kOpenSd;
    const double deviation = std::pow(2.0 * options_.deviation_deg * kDegree, 2);
    for (const int k : {kMeanPitch, kMeanRoll}) state_.covariance(k, k) += deviation;
  }

  bool started() const override { return started_; }
  GroundState state() const override { return public_form(state_); }

  int keep() override {
    kept_.push_back({transition_, predicted_, state_, started_});
    transition_.setIdentity();
    predicted_ = state_;
    return static_cast<int>(kept_.size()) - 1;
  }

  std::vector<GroundState> smoothed() const override {
    std::vector<GroundState> states(kept_.size());
    State later;
    for (std::size_t k = kept_.size(); k-- > 0;) {
      const bool last = k + 1 == kept_.size();
      const bool chained = !last && kept_[k].started;
      later = chained ? smooth<5>(kept_[k].filtered, kept_[k + 1].predicted, later, kept_[k + 1].transition)
                      : kept_[k].filtered;
      states[k] = public_form(later);
    }
    return states;
  }

 private:
  struct Kept {
    Transition transition;  ///< From the frame before.
    State predicted, filtered;
    bool started;
  };

  static GroundState public_form(const State& state) {
    return {.pitch_rad = state.mean(kMeanPitch) + state.mean(kPitch),
            .roll_rad = state.mean(kMeanRoll) + state.mean(kRoll),
            .mean_pitch_rad = state.mean(kMeanPitch),
            .mean_roll_rad = state.mean(kMeanRoll),
            .speed_mps = std::exp(state.mean(kLogSpeed)),
            .log_speed_sd = std::sqrt(std::max(0.0, state.covariance(kLogSpeed, kLogSpeed)))};
  }

  /// Change of log speed and its variance: no acceleration on average, and what the points' structure says.
  std::pair<double, double> speed_change(const GroundStep& step) const {
    constexpr double kMinSpeed = 0.5;  // m/s: at a crawl, speed changes by any factor
    const double speed = std::max(kMinSpeed, std::exp(state_.mean(kLogSpeed)));
    const double prior = std::pow(options_.acceleration_mps2 * step.dt_s / speed, 2);
    if (!step.log_speed_change) return {0.0, prior};
    const double measured = step.log_speed_change_sd * step.log_speed_change_sd;
    const double gain = prior / (prior + measured);
    return {gain * *step.log_speed_change, gain * measured};
  }

  GroundFilterOptions options_;
  bool started_ = false;
  State state_, predicted_;
  Transition transition_ = Transition::Identity();
  std::vector<Kept> kept_;
};

}  // namespace

std::unique_ptr<GroundFilter> make_model_filter(const GroundFilterOptions& options) {
  return std::make_unique<ModelFilter>(options);
}

}  // namespace groundscale
