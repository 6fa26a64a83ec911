#include "groundscale/experiments/compared_system.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "groundscale/geometry/similarity.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::bad_input;

constexpr std::string_view kPlace = "{}";
constexpr std::string_view kSim3 = "sim3";

Result<ComparedSystem> parse_one(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    return bad_input(fmt::format("--compare {}: must be NAME=POSES or NAME@sim3=POSES", internal::quoted(text)));
  }
  ComparedSystem system{.name = text.substr(0, equals), .poses = text.substr(equals + 1)};
  const std::size_t at = system.name.find('@');
  if (at != std::string::npos) {
    if (std::string_view(system.name).substr(at + 1) != kSim3 || at == 0) {
      return bad_input(
          fmt::format("--compare {}: the name may end in @sim3 and has no other '@'", internal::quoted(text)));
    }
    system.sim3 = true;
    system.name.resize(at);
  }
  if (internal::printable(system.name) != system.name) {
    return bad_input(fmt::format("--compare {}: the name must be printable ASCII", internal::quoted(text)));
  }
  return system;
}

bool names_one_file(const ComparedSystem& system) {
  std::error_code ignored;
  return system.poses.find(kPlace) == std::string::npos && !fs::is_directory(system.poses, ignored);
}

Result<Trajectory> read_rows(const ComparedSystem& system, const std::string& file, int frames) {
  auto trajectory = read_trajectory(file);
  if (!trajectory) return Error{ErrorCode::kBadInput, "--compare " + trajectory.error().message};
  if (trajectory->has_times()) {
    return bad_input(fmt::format("--compare {}: {}: has TUM rows; KITTI rows (12 numbers, row i is frame i) are needed",
                                 system.name, file));
  }
  if (trajectory->size() >= frames) return trajectory;
  return bad_input(fmt::format("--compare {}: {}: {} rows, but the drive has {} frames", system.name, file,
                               trajectory->size(), frames));
}

}  // namespace

Result<std::vector<ComparedSystem>> parse_compared(const std::vector<std::string>& texts,
                                                   const std::vector<std::string>& taken) {
  std::vector<ComparedSystem> systems;
  for (const std::string& text : texts) {
    auto system = parse_one(text);
    if (!system) return system.error();
    const auto same = [&system](const ComparedSystem& other) { return other.label() == system->label(); };
    if (std::any_of(systems.begin(), systems.end(), same)) {
      return bad_input(fmt::format("--compare: '{}' is there twice", system->name));
    }
    if (std::find(taken.begin(), taken.end(), system->name) != taken.end()) {
      return bad_input(fmt::format("--compare {}: '{}' has a meaning here, another name is needed",
                                   internal::quoted(text), system->name));
    }
    systems.push_back(std::move(*system));
  }
  return systems;
}

std::string compared_file(const ComparedSystem& system, const std::string& sequence) {
  if (names_one_file(system)) return system.poses;
  std::string file = system.poses;
  std::size_t at = file.find(kPlace);
  if (at == std::string::npos) file = (fs::path(system.poses) / (sequence + ".txt")).string();
  while (at != std::string::npos) {
    file.replace(at, kPlace.size(), sequence);
    at = file.find(kPlace, at + sequence.size());
  }
  std::error_code ignored;
  return fs::is_regular_file(file, ignored) ? file : "";
}

Result<void> check_compared(const std::vector<ComparedSystem>& systems, const std::vector<DriveChoice>& drives) {
  for (const ComparedSystem& system : systems) {
    if (names_one_file(system) && drives.size() > 1) {
      return bad_input(
          fmt::format("--compare {}: {} is one file, but there are {} drives: a folder with NN.txt or a "
                      "path with {{}} for the sequence is needed",
                      system.name, system.poses, drives.size()));
    }
    bool any = false;
    for (const DriveChoice& drive : drives) {
      const std::string file = compared_file(system, drive.name);
      if (file.empty()) continue;
      any = true;
      if (const auto rows = read_rows(system, file, drive.frames); !rows) return rows.error();
    }
    if (any) continue;
    return bad_input(fmt::format("--compare {}: {} holds nothing for any drive, {}.txt for example", system.name,
                                 system.poses, drives.front().name));
  }
  return {};
}

Result<ComparedPath> read_compared(const ComparedSystem& system, const std::string& sequence, const Trajectory& truth) {
  auto rows = read_rows(system, compared_file(system, sequence), truth.size());
  if (!rows) return rows.error();
  ComparedPath compared{.path = std::move(*rows), .rows_in_file = 0};
  compared.rows_in_file = compared.path.size();
  compared.path.world_from_cam.resize(truth.world_from_cam.size());
  if (!system.sim3) return compared;
  auto aligned = aligned_by_sim3(compared.path, truth);
  if (!aligned) return Error{aligned.error().code, fmt::format("{}: {}", system.label(), aligned.error().message)};
  compared.path = std::move(*aligned);
  return compared;
}

Result<Trajectory> aligned_by_sim3(const Trajectory& estimate, const Trajectory& truth) {
  const auto places = [](const Trajectory& trajectory) {
    std::vector<Eigen::Vector3d> all;
    for (const RigidTransform& pose : trajectory.world_from_cam) all.push_back(pose.translation);
    return all;
  };
  const auto truth_from_estimate = align_points(places(estimate), places(truth), /*with_scale=*/true);
  if (!truth_from_estimate) return truth_from_estimate.error();
  Trajectory aligned = estimate;
  for (RigidTransform& pose : aligned.world_from_cam) {
    pose = {truth_from_estimate->rotation * pose.rotation, *truth_from_estimate * pose.translation};
  }
  return aligned;
}

}  // namespace groundscale
