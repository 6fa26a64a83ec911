#include "groundscale/experiments/method_choice.hpp"

#include <algorithm>

#include "groundscale/io/config.hpp"
#include "groundscale/odometry/method_comparison.hpp"
#include "groundscale/odometry/run_source.hpp"
#include "groundscale/road/ground_methods.hpp"

namespace groundscale {

Result<std::vector<PlaneMethod>> choose_ground_methods(const std::vector<std::string>& names,
                                                       const std::vector<std::string_view>& defaults) {
  if (!names.empty()) return choose_methods(names);
  std::vector<PlaneMethod> chosen;
  for (const PlaneMethod& method : ground_methods()) {
    const bool wanted = std::find(defaults.begin(), defaults.end(), method.name) != defaults.end();
    if (wanted || defaults.empty()) chosen.push_back(method);
  }
  return chosen;
}

Result<OdometryOptions> assigned_options(const OdometryOptions& start, const std::vector<std::string>& assignments) {
  RunConfig config{.odometry = start, .run = {}};
  const VisitOptions visit = [&config](FieldVisitor& visitor) { visit_fields(config, visitor); };
  for (const std::string& assignment : assignments) {
    if (const auto done = apply_assignment(assignment, visit); !done) return done.error();
  }
  if (const auto valid = config.odometry.validate(); !valid) return valid.error();
  return config.odometry;
}

}  // namespace groundscale
