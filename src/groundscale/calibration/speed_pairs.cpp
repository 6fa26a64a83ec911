#include "groundscale/calibration/speed_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "groundscale/core/check.hpp"
#include "groundscale/estimation/robust.hpp"

namespace groundscale {

std::vector<LogPiece> pieces_of(const SpeedLog& log) {
  constexpr double kPieceS = 0.95;
  const std::vector<SpeedSample>& samples = log.samples();
  std::vector<LogPiece> pieces;
  std::size_t begin = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    if (log.is_gap(k)) {
      begin = k;
      continue;
    }
    const double from_s = samples[begin].time_s;
    const double to_s = samples[k].time_s;
    if (to_s - from_s < kPieceS) continue;
    pieces.push_back({from_s, to_s, log.distance_m(from_s, to_s).value_or(0.0)});
    begin = k;
  }
  return pieces;
}

std::vector<SpeedPair> pairs_at(const std::vector<LogPiece>& pieces, const Odometer& odometer, double offset_s) {
  std::vector<SpeedPair> pairs;
  for (const LogPiece& piece : pieces) {
    const double from_s = piece.from_s - offset_s;
    const double to_s = piece.to_s - offset_s;
    const std::optional<double> way_m = odometer.distance_m(from_s, to_s);
    if (!way_m) continue;
    const double interval_s = to_s - from_s;
    pairs.push_back({0.5 * (from_s + to_s), interval_s, piece.way_m / interval_s, *way_m / interval_s});
  }
  return pairs;
}

RatioFit fit_ratio(const std::vector<SpeedPair>& pairs, const SpeedNoise& noise) {
  double log_sum = 0.0;
  double driven_sum = 0.0;
  for (const SpeedPair& pair : pairs) {
    log_sum += pair.interval_s * pair.log_mps;
    driven_sum += pair.interval_s * pair.driven_mps;
  }
  RatioFit fit;
  if (!(driven_sum > 0.0)) return fit;
  fit.ratio = log_sum / driven_sum;
  constexpr HuberLoss kLoss{2.0};
  constexpr int kIterations = 6;
  for (int iteration = 0; iteration <= kIterations; ++iteration) {
    double weighted_log = 0.0, weighted_driven = 0.0, variance_sum = 0.0, cost = 0.0;
    for (const SpeedPair& pair : pairs) {
      const double driven_sd = noise.driven_relative * fit.ratio * pair.driven_mps;
      const double variance = noise.log_mps * noise.log_mps + driven_sd * driven_sd;
      const double normalised = (pair.log_mps - fit.ratio * pair.driven_mps) / std::sqrt(variance);
      const double weight = pair.interval_s * kLoss.weight(normalised);
      weighted_log += weight * pair.log_mps;
      weighted_driven += weight * pair.driven_mps;
      variance_sum += weight * weight * variance;
      cost += 2.0 * kLoss.rho(normalised);
    }
    fit.cost = cost / static_cast<double>(pairs.size());
    fit.formal_sd = std::sqrt(variance_sum) / weighted_driven;
    if (iteration < kIterations && weighted_driven > 0.0) fit.ratio = weighted_log / weighted_driven;
  }
  return fit;
}

double noise_about(const std::vector<SpeedPair>& pairs, double ratio) {
  constexpr double kLeastMps = 0.02;
  constexpr double kSdOfMad = 1.4826;
  std::vector<double> residuals;
  for (const SpeedPair& pair : pairs) residuals.push_back(std::abs(pair.log_mps - ratio * pair.driven_mps));
  return residuals.empty() ? kLeastMps : std::max(kLeastMps, kSdOfMad * median(std::move(residuals)));
}

double duration_of(const std::vector<SpeedPair>& pairs) {
  double duration_s = 0.0;
  for (const SpeedPair& pair : pairs) duration_s += pair.interval_s;
  return duration_s;
}

}  // namespace groundscale
