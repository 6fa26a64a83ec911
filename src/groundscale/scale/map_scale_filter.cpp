#include "groundscale/scale/map_scale_filter.hpp"

#include <algorithm>
#include <cmath>

#include "groundscale/core/check.hpp"

namespace groundscale {

void visit_fields(MapScaleFilterOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "walk", .unit = "1/sqrt(m)", .help = "random walk of log scale", .min = 0, .max = 0.1},
                options.walk);
  visitor.field({.key = "turn_walk", .unit = "1/sqrt(rad)", .help = "the same for turning", .min = 0, .max = 1},
                options.turn_walk);
  visitor.field({.key = "turn_drift_sd",
                 .unit = "1/rad",
                 .help = "prior of the scale's drift by turning, which a wrong calibration makes",
                 .min = 0.0001,
                 .max = 10},
                options.turn_drift_sd);
  visitor.field({.key = "turn_drift_walk",
                 .unit = "1/rad/sqrt(m)",
                 .help = "random walk of that drift",
                 .min = 0.00001,
                 .max = 1},
                options.turn_drift_walk);
  visitor.field({.key = "start_sd", .unit = "", .help = "sd of log scale at a map's start", .min = 0.001, .max = 1},
                options.start_sd);
}

MapScaleFilter::MapScaleFilter(const MapScaleFilterOptions& options) : options_(options) {
  state_.covariance << 0.0, 0.0, 0.0, options_.turn_drift_sd * options_.turn_drift_sd;
  start(0.0, options.start_sd);
}

void MapScaleFilter::start(double log_scale, double sd) {
  state_.mean(0) = log_scale;
  state_.covariance.row(0).setZero();
  state_.covariance.col(0).setZero();
  state_.covariance(0, 0) = sd * sd;
  predicted_ = state_;
  transition_.setIdentity();
  started_ = true;
}

void MapScaleFilter::change_unit(double log_ratio) {
  // The smoother sees differences from what was predicted: a shift of both passes it by.
  state_.mean(0) += log_ratio;
  predicted_.mean(0) += log_ratio;
}

void MapScaleFilter::predict(double distance_m, double turn_rad) {
  Eigen::Matrix2d transition;
  transition << 1.0, std::abs(turn_rad), 0.0, 1.0;
  Eigen::Matrix2d noise = Eigen::Matrix2d::Zero();
  constexpr double kLeast = 1e-12;  // for the smoother, which inverts
  noise(0, 0) = kLeast + options_.walk * options_.walk * distance_m +
                options_.turn_walk * options_.turn_walk * std::abs(turn_rad);
  noise(1, 1) = kLeast + options_.turn_drift_walk * options_.turn_drift_walk * distance_m;
  state_ = groundscale::predict(state_, transition, noise);
  predicted_ = state_;
  transition_ = Eigen::Matrix2d(transition * transition_);
}

void MapScaleFilter::update(double log_scale, double sd, double turned_rad) {
  const Eigen::Matrix<double, 1, 2> observation(1.0, -std::abs(turned_rad));
  const Eigen::Matrix<double, 1, 1> residual(log_scale - observation * state_.mean);
  constexpr double kBoundSd = 2.5;
  const double off =
      std::abs(residual(0)) / std::sqrt((observation * state_.covariance * observation.transpose())(0) + sd * sd);
  const Eigen::Matrix<double, 1, 1> noise(sd * sd * std::max(1.0, off / kBoundSd));
  state_ = groundscale::update<2, 1>(state_, observation, residual, noise);
}

double MapScaleFilter::sd() const { return std::sqrt(std::max(0.0, state_.covariance(0, 0))); }

double MapScaleFilter::drift_per_rad_sd() const { return std::sqrt(std::max(0.0, state_.covariance(1, 1))); }

void MapScaleFilter::keep() {
  kept_.push_back({transition_, predicted_, state_, started_});
  transition_.setIdentity();
  predicted_ = state_;
  started_ = false;
}

void MapScaleFilter::keep_again(int frames) {
  GS_CHECK(frames >= 0 && static_cast<std::size_t>(frames) <= kept_.size(), "frames that were kept");
  kept_.erase(kept_.end() - frames, kept_.end());
  for (int k = 0; k < frames; ++k) {
    predict(0.0, 0.0);
    keep();
  }
}

std::vector<MapScaleFilter::Smoothed> MapScaleFilter::smoothed() const {
  std::vector<Smoothed> result(kept_.size());
  State later;
  for (std::size_t k = kept_.size(); k-- > 0;) {
    const bool chained = k + 1 < kept_.size() && !kept_[k + 1].started;
    later = chained ? smooth<2>(kept_[k].filtered, kept_[k + 1].predicted, later, kept_[k + 1].transition)
                    : kept_[k].filtered;
    result[k] = {later.mean(0), std::sqrt(std::max(0.0, later.covariance(0, 0)))};
  }
  return result;
}

}  // namespace groundscale
