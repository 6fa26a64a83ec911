#include "groundscale/experiments/odometry_modes.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "groundscale/io/text_internal.hpp"
#include "groundscale/odometry/options.hpp"

namespace groundscale {
namespace {

constexpr const char* kPairwise = "pairwise";

bool is_among(const std::string& name, const std::vector<std::string>& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

std::vector<std::string> mode_names() {
  std::vector<std::string> names;
  for (const std::string_view name : names_of<ScaleCorrection>()) names.emplace_back(name);
  names.emplace_back(kPairwise);
  return names;
}

std::string default_mode() {
  const PipelineOptions options;
  if (options.mode == OdometryMode::kPairwise) return kPairwise;
  return std::string(names_of<ScaleCorrection>()[static_cast<std::size_t>(options.scale_correction)]);
}

Result<std::vector<std::string>> choose_modes(const std::vector<std::string>& wanted) {
  if (wanted.empty()) return std::vector<std::string>{"none", default_mode()};
  std::vector<std::string> modes;
  for (const std::string& mode : wanted) {
    if (!is_among(mode, mode_names())) {
      return internal::bad_input(
          fmt::format("--modes: {} is no mode, known: {}", internal::quoted(mode), fmt::join(mode_names(), ", ")));
    }
    if (is_among(mode, modes)) return internal::bad_input(fmt::format("--modes: '{}' is there twice", mode));
    modes.push_back(mode);
  }
  return modes;
}

std::string best_mode(const std::vector<std::string>& modes) {
  return is_among(default_mode(), modes) ? default_mode() : modes.back();
}

std::vector<std::string> mode_assignments(const std::string& mode) {
  if (mode == kPairwise) return {"odometry.mode=pairwise"};
  return {"odometry.mode=keyframe", "odometry.scale_correction=" + mode};
}

}  // namespace groundscale
