#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "groundscale/experiments/paper_finding.hpp"
#include "groundscale/experiments/plot.hpp"
#include "groundscale/experiments/synthetic.hpp"
#include "groundscale/experiments/synthetic_trial.hpp"
#include "groundscale/experiments/table.hpp"
#include "groundscale/odometry/options.hpp"
#include "groundscale/plane/methods.hpp"

namespace groundscale::internal {

/// A method, and how wrong the pitch is that it is told.
struct SyntheticContender {
  std::string method;
  double pitch_error_deg = 0.0;

  /// "triangulation, pitch +0.5 deg"
  std::string label() const;
};

/// Where curves are drawn over the noise.
struct SyntheticSetting {
  double speed_kmh = 0.0;
  double step_m = 0.0;  ///< From frame to frame, straight ahead.
  bool true_motion = true;

  /// "12.5 km/h, true R, t"
  std::string label() const;
};

/// Errors of one method at one setting and noise level, a trial each.
struct SyntheticErrors {
  SyntheticSetting setting;
  double noise_px = 0.0;
  SyntheticContender contender;
  /// |scale / true scale - 1|; infinite where the method refused, so that a quantile takes no advantage of that.
  std::vector<double> errors;

  double quantile(double fraction) const;
  double median() const;
  int refused() const;
};

struct SyntheticResults {
  std::vector<SyntheticSetting> settings;
  std::vector<double> noise_px;
  std::vector<SyntheticContender> contenders;
  std::vector<SyntheticErrors> points;  ///< By setting, then noise, then contender.

  const SyntheticErrors& at(std::size_t setting, std::size_t noise, std::size_t contender) const;
};

/// What the trials are made of.
struct SyntheticBench {
  SyntheticWorld world;
  std::vector<std::vector<Eigen::Vector2d>> features;  ///< In the road region, a frame each.
  std::vector<PlaneMethod> methods;
  OdometryOptions options;
  std::string source;  ///< Where the features come from, in words.
};

/// There are no outliers here, so nothing may be refused for its noise: thresholds of 5 sd of 2 px, losses with 95 % of
/// least squares' efficiency at 2 px (Huber: 1.345 sd, Cauchy: 2.385 sd) and more below. No method is told the normal
/// but those that need it.
OdometryOptions synthetic_settings();

/// All trials. Trial k has the same scene and noise in every setting, and the same for every method.
SyntheticResults measure_synthetic(const SyntheticBench& bench, const SyntheticOptions& options,
                                   const std::function<void(std::string_view)>& say);

/// A row a setting, noise level and contender.
Table synthetic_table(const SyntheticResults& results);
/// A row a noise level, a column a contender: medians in percent; below, their means over the levels.
std::string synthetic_overview(const SyntheticResults& results, std::size_t setting);
/// A figure a setting: medians, and bands between the quartiles.
std::vector<Plot> synthetic_plots(const SyntheticResults& results);

/// What the paper found, judged by medians, setting by setting:
/// - `decomposition` is worse than `sparse`: at every noise level above 0;
/// - `triangulation` is best of all at high speed (the highest): at every noise level above 0;
/// - `triangulation` is far worse than `sparse` at low speed (the lowest) beyond 1 px: at least twice its error at
///   every noise level above 1 px;
/// - `joint` is worse than `sparse`, which takes R and t as given: at every noise level above 0.
std::vector<PaperFinding> synthetic_findings(const SyntheticResults& results);

}  // namespace groundscale::internal
