#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "groundscale/experiments/synthetic_results_internal.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale::internal {
namespace {

constexpr const char* kTriangulation = "triangulation";
constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kKmhPerMps = 3.6;
constexpr double kRefused = std::numeric_limits<double>::infinity();

/// Only `triangulation` believes in the pitch.
std::vector<SyntheticContender> contenders_of(const std::vector<PlaneMethod>& methods,
                                              const std::vector<double>& pitch_errors_deg) {
  std::vector<SyntheticContender> contenders;
  for (const PlaneMethod& method : methods) {
    if (method.name != kTriangulation) {
      contenders.push_back({std::string(method.name), 0.0});
      continue;
    }
    for (const double error : pitch_errors_deg) contenders.push_back({kTriangulation, error});
  }
  return contenders;
}

/// So that 18 steps of 0.1 are 1.8.
double rounded(double value) {
  constexpr double kUnit = 1e6;
  return std::round(value * kUnit) / kUnit;
}

/// All points, without errors.
SyntheticResults plan(const std::vector<PlaneMethod>& methods, const SyntheticOptions& options) {
  SyntheticResults results;
  for (const double speed : options.speeds_kmh) {
    const double step_m = speed / kKmhPerMps / options.rate_hz;
    for (const bool true_motion : {true, false}) results.settings.push_back({speed, step_m, true_motion});
  }
  constexpr double kRounding = 1e-9;  // 2 px in steps of 0.1 px are twenty
  const auto levels = static_cast<int>(std::floor(options.max_noise_px / options.noise_step_px + kRounding));
  for (int k = 0; k <= levels; ++k) results.noise_px.push_back(rounded(k * options.noise_step_px));
  results.contenders = contenders_of(methods, options.pitch_errors_deg);
  for (const SyntheticSetting& setting : results.settings) {
    for (const double noise : results.noise_px) {
      for (const SyntheticContender& contender : results.contenders) {
        results.points.push_back({setting, noise, contender, {}});
      }
    }
  }
  return results;
}

/// Random numbers of a trial: those of its scene (0), of the motion (1), of a method (2), whichever.
std::uint64_t seed_of(int seed, int trial, std::uint64_t use) {
  constexpr int kSeedShift = 34, kTrialShift = 2;
  return (static_cast<std::uint64_t>(seed) << kSeedShift) + (static_cast<std::uint64_t>(trial) << kTrialShift) + use;
}

double error_of(const EstimatePlane& estimate, const RoadObservations& observations, double true_height,
                std::uint64_t seed) {
  Rng rng(seed);
  const auto measured = estimate(observations, rng);
  if (!measured || !(measured->plane.height > 0.0)) return kRefused;
  return std::abs(true_height / measured->plane.height - 1.0);
}

/// Errors of all contenders on the same observations.
std::vector<double> errors_of(const SyntheticBench& bench, const std::vector<SyntheticContender>& contenders,
                              RoadObservations observations, double true_height, std::uint64_t seed) {
  std::vector<double> errors;
  const Eigen::Vector3d normal = observations.expected_normal;
  for (const SyntheticContender& contender : contenders) {
    const auto method = std::find_if(bench.methods.begin(), bench.methods.end(),
                                     [&](const PlaneMethod& one) { return one.name == contender.method; });
    observations.expected_normal = exp_so3({contender.pitch_error_deg * kRadPerDeg, 0.0, 0.0}) * normal;
    errors.push_back(error_of(method->make(bench.options.ground.plane), observations, true_height, seed));
  }
  return errors;
}

}  // namespace

OdometryOptions synthetic_settings() {
  OdometryOptions options;
  options.ground.plane.max_epipolar_px = 10.0;
  options.ground.plane.max_error_px = 10.0;
  options.ground.plane.huber_px = 2.7;
  options.ground.plane.normal_prior_deg = 0.0;
  options.motion.max_error_px = 10.0;
  options.motion.loss_px = 4.8;
  return options;
}

SyntheticResults measure_synthetic(const SyntheticBench& bench, const SyntheticOptions& options,
                                   const std::function<void(std::string_view)>& say) {
  SyntheticResults results = plan(bench.methods, options);
  auto point = results.points.begin();
  const auto contenders = static_cast<std::ptrdiff_t>(results.contenders.size());
  for (const SyntheticSetting& setting : results.settings) {
    say(fmt::format("{}: {} trials at each of {} noise levels", setting.label(), options.trials,
                    results.noise_px.size()));
    const RigidTransform motion{Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.0, 0.0, -setting.step_m)};
    const double true_height = bench.world.metric_road.height / setting.step_m;
    for (const double noise_px : results.noise_px) {
      for (int k = 0; k < options.trials; ++k) {
        const auto& features = bench.features[static_cast<std::size_t>(k) % bench.features.size()];
        const SyntheticTrial trial(bench.world, features, seed_of(options.seed, k, 0));
        std::optional<RoadObservations> observations = trial.observe(motion, noise_px);
        if (!setting.true_motion) {
          Rng rng(seed_of(options.seed, k, 1));
          observations = with_estimated_motion(*std::move(observations), bench.options.motion, rng);
        }
        const std::vector<double> errors = observations ? errors_of(bench, results.contenders, *std::move(observations),
                                                                    true_height, seed_of(options.seed, k, 2))
                                                        : std::vector<double>(results.contenders.size(), kRefused);
        for (std::ptrdiff_t c = 0; c < contenders; ++c) {
          (point + c)->errors.push_back(errors[static_cast<std::size_t>(c)]);
        }
      }
      point += contenders;
    }
  }
  return results;
}

}  // namespace groundscale::internal
