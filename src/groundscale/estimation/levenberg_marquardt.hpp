#pragma once

#include <algorithm>
#include <concepts>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace groundscale {

/// A cost near one state, to second order without the second derivatives of the residuals: information J^T W J and
/// gradient J^T W r of N parameters.
template <int N>
struct NormalEquations {
  Eigen::Matrix<double, N, N> information = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, 1> gradient = Eigen::Matrix<double, N, 1>::Zero();
};

/// What is minimised: the cost of a state, its normal equations there, and the state one step (of kParameters numbers)
/// away.
template <class P>
concept LeastSquaresProblem = requires(const P& problem, const typename P::State& state,
                                       const Eigen::Matrix<double, P::kParameters, 1>& step) {
  { problem.cost(state) } -> std::convertible_to<double>;
  { problem.linearise(state) } -> std::same_as<NormalEquations<P::kParameters>>;
  { problem.moved(state, step) } -> std::same_as<typename P::State>;
};

/// State nearby with the least cost: damped Gauss-Newton steps (Levenberg 1944, Marquardt 1963), for costs of which one
/// evaluation is cheap and a few parameters are sought. Never ends with a higher cost than it started with. Ends where
/// no step helps or one gains less than 1e-7 of the cost, after 20 steps at the latest. Deterministic.
template <LeastSquaresProblem P>
typename P::State levenberg_marquardt(const P& problem, typename P::State state) {
  constexpr int kMaxIterations = 20;
  constexpr int kMaxAttempts = 6;
  constexpr double kMinGain = 1e-7;
  double cost = problem.cost(state);
  double damping = 1e-4;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const NormalEquations<P::kParameters> equations = problem.linearise(state);
    bool moved = false;
    double gain = 0.0;
    for (int attempt = 0; attempt < kMaxAttempts && !moved; ++attempt) {
      auto damped = equations.information;
      damped.diagonal() *= 1.0 + damping;
      const Eigen::Matrix<double, P::kParameters, 1> step = -damped.ldlt().solve(equations.gradient);
      if (!step.allFinite()) {
        damping *= 10.0;
        continue;
      }
      const typename P::State next = problem.moved(state, step);
      const double next_cost = problem.cost(next);
      if (next_cost < cost) {
        gain = cost - next_cost;
        state = next;
        cost = next_cost;
        damping = std::max(1e-9, damping * 0.1);
        moved = true;
      } else {
        damping *= 10.0;
      }
    }
    if (!moved || gain < kMinGain * cost) break;
  }
  return state;
}

}  // namespace groundscale
