#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

namespace groundscale {

/// A normal distribution of a state of N numbers.
template <int N>
struct Gaussian {
  Eigen::Matrix<double, N, 1> mean = Eigen::Matrix<double, N, 1>::Zero();
  Eigen::Matrix<double, N, N> covariance = Eigen::Matrix<double, N, N>::Identity();
};

/// x <- F x, P <- F P F^T + Q. An offset of the mean is the caller's.
template <int N>
Gaussian<N> predict(const Gaussian<N>& state, const Eigen::Matrix<double, N, N>& transition,
                    const Eigen::Matrix<double, N, N>& process_noise) {
  return {transition * state.mean, transition * state.covariance * transition.transpose() + process_noise};
}

/// Innovation of a measurement z = H x + v, v ~ (0, R), and its squared Mahalanobis length.
template <int N, int M>
struct Innovation {
  Eigen::Matrix<double, M, 1> residual;
  Eigen::Matrix<double, M, M> covariance;
  double squared_length() const { return residual.dot(covariance.inverse() * residual); }
};

template <int N, int M>
Innovation<N, M> innovation_of(const Gaussian<N>& state, const Eigen::Matrix<double, M, N>& observation,
                               const Eigen::Matrix<double, M, 1>& residual,
                               const Eigen::Matrix<double, M, M>& measurement_noise) {
  return {residual, observation * state.covariance * observation.transpose() + measurement_noise};
}

/// Kalman update with residual z - h(x), in Joseph's form, which keeps the covariance symmetric and positive.
template <int N, int M>
Gaussian<N> update(const Gaussian<N>& state, const Eigen::Matrix<double, M, N>& observation,
                   const Eigen::Matrix<double, M, 1>& residual, const Eigen::Matrix<double, M, M>& measurement_noise) {
  const Eigen::Matrix<double, M, M> innovation =
      observation * state.covariance * observation.transpose() + measurement_noise;
  const Eigen::Matrix<double, N, M> gain = state.covariance * observation.transpose() * innovation.inverse();
  const Eigen::Matrix<double, N, N> keep = Eigen::Matrix<double, N, N>::Identity() - gain * observation;
  return {state.mean + gain * residual,
          keep * state.covariance * keep.transpose() + gain * measurement_noise * gain.transpose()};
}

/// One step of Rauch-Tung-Striebel: the state at k given all data, from the filtered state at k, the state predicted
/// for k + 1 and the smoothed state at k + 1. `transition` leads from k to k + 1.
template <int N>
Gaussian<N> smooth(const Gaussian<N>& filtered, const Gaussian<N>& predicted_next, const Gaussian<N>& smoothed_next,
                   const Eigen::Matrix<double, N, N>& transition) {
  const Eigen::Matrix<double, N, N> gain =
      filtered.covariance * transition.transpose() * predicted_next.covariance.inverse();
  return {filtered.mean + gain * (smoothed_next.mean - predicted_next.mean),
          filtered.covariance + gain * (smoothed_next.covariance - predicted_next.covariance) * gain.transpose()};
}

/// First-order Gauss-Markov process: x(t + dt) = a x(t) + w, a = exp(-dt / tau), var(w) = sigma^2 (1 - a^2).
struct GaussMarkov {
  double sigma = 1.0;
  double correlation_time_s = 1.0;
  double decay(double dt_s) const;
  double noise_variance(double dt_s) const;
};

}  // namespace groundscale
