#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <optional>
#include <span>
#include <vector>

#include "groundscale/core/options.hpp"
#include "groundscale/core/rng.hpp"

namespace groundscale {

struct RansacOptions {
  int min_trials = 20;
  int max_trials = 300;
  double confidence = 0.999;
};

void visit_fields(RansacOptions& options, FieldVisitor& visitor);

/// What a RANSAC loop needs to know: how many items there are, how to make models of a sample, how far items are away
/// (of either sign).
template <class P>
concept RansacProblem = requires(const P& problem, std::span<const int> sample, const typename P::Model& model,
                                 int item) {
  { P::kSampleSize } -> std::convertible_to<int>;
  { problem.count() } -> std::convertible_to<int>;
  { problem.fit(sample) } -> std::same_as<std::vector<typename P::Model>>;
  { problem.error(model, item) } -> std::convertible_to<double>;
  { problem.max_error() } -> std::convertible_to<double>;
};

template <class Model>
struct RansacResult {
  Model model;
  std::vector<int> inliers;  ///< Indices with an error of at most max_error, ascending.
  int trials = 0;
};

/// Inliers of a model, ascending.
template <RansacProblem P>
std::vector<int> inliers_of(const P& problem, const typename P::Model& model) {
  std::vector<int> inliers;
  for (int i = 0; i < problem.count(); ++i) {
    if (std::abs(problem.error(model, i)) <= problem.max_error()) inliers.push_back(i);
  }
  return inliers;
}

/// Best model by truncated squared error (MSAC, Torr and Zisserman 2000), with adaptive stopping.
///
/// `guesses` are tried before any sample. Deterministic for a given rng. Nothing where no model has kSampleSize
/// inliers.
template <RansacProblem P>
std::optional<RansacResult<typename P::Model>> ransac(const P& problem, const RansacOptions& options, Rng& rng,
                                                      const std::vector<typename P::Model>& guesses = {}) {
  constexpr int kSize = P::kSampleSize;
  const int count = problem.count();
  if (count < kSize) return std::nullopt;
  const double truncation = problem.max_error() * problem.max_error();
  std::optional<typename P::Model> best;
  double best_cost = truncation * count;
  double needed = options.max_trials;

  const auto consider = [&](const typename P::Model& model) {
    double cost = 0.0;
    int inliers = 0;
    for (int i = 0; i < count && cost < best_cost; ++i) {
      const double error = problem.error(model, i);
      const double squared = error * error;
      if (squared <= truncation) ++inliers;
      cost += std::isfinite(squared) ? std::min(squared, truncation) : truncation;
    }
    if (!(cost < best_cost)) return;
    best = model;
    best_cost = cost;
    const double all_inliers = std::pow(static_cast<double>(inliers) / count, kSize);
    needed = all_inliers >= 1.0 ? 0.0 : std::log(1.0 - options.confidence) / std::log1p(-all_inliers);
  };

  for (const auto& guess : guesses) consider(guess);
  int trial = 0;
  for (; trial < options.max_trials && (trial < options.min_trials || trial < needed); ++trial) {
    std::array<int, static_cast<std::size_t>(kSize)> sample{};
    for (int drawn = 0; drawn < kSize;) {
      const int candidate = rng.index(count);
      if (std::find(sample.begin(), sample.begin() + drawn, candidate) != sample.begin() + drawn) continue;
      sample[static_cast<std::size_t>(drawn++)] = candidate;
    }
    for (const auto& model : problem.fit(sample)) consider(model);
  }
  if (!best) return std::nullopt;
  RansacResult<typename P::Model> result{*best, inliers_of(problem, *best), trial};
  if (static_cast<int>(result.inliers.size()) < kSize) return std::nullopt;
  return result;
}

}  // namespace groundscale
