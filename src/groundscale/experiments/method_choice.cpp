#include "groundscale/experiments/method_choice.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "groundscale/io/config.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/odometry/run_source.hpp"
#include "groundscale/road/ground_methods.hpp"

namespace groundscale {

Result<std::vector<PlaneMethod>> choose_ground_methods(const std::vector<std::string>& names,
                                                       const std::vector<std::string_view>& defaults) {
  std::vector<PlaneMethod> chosen;
  if (names.empty() && defaults.empty()) {
    const auto all = ground_methods();
    chosen.assign(all.begin(), all.end());
  } else if (names.empty()) {
    for (const std::string_view name : defaults) {
      if (const PlaneMethod* method = find_ground_method(name)) chosen.push_back(*method);
    }
  }
  for (const std::string& name : names) {
    const PlaneMethod* method = find_ground_method(name);
    if (method == nullptr) {
      return internal::bad_input(
          fmt::format("--methods: {} is no method, known: {}", internal::quoted(name), ground_method_names()));
    }
    const auto same = [&name](const PlaneMethod& other) { return other.name == name; };
    if (std::any_of(chosen.begin(), chosen.end(), same)) {
      return internal::bad_input(fmt::format("--methods: '{}' is there twice", name));
    }
    chosen.push_back(*method);
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
