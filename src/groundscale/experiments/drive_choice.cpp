#include "groundscale/experiments/drive_choice.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <system_error>

#include <fmt/format.h>

#include "groundscale/experiments/recorded_drive.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "groundscale/simulation/drive_simulation.hpp"
#include "groundscale/simulation/route.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::bad_input;

constexpr int kMinFrames = 2;

/// A sequence and how much of it.
struct Wanted {
  std::string name;
  int frames = std::numeric_limits<int>::max();
};

Result<Wanted> parse_wanted(const std::string& text) {
  const std::size_t colon = text.find(':');
  Wanted wanted{.name = text.substr(0, colon)};
  if (colon != std::string::npos) {
    const auto frames = internal::parse_integer(std::string_view(text).substr(colon + 1));
    if (!frames || *frames < kMinFrames || *frames > wanted.frames) {
      return bad_input(
          fmt::format("--sequences {}: after ':' there must be a number of frames, at least {}", text, kMinFrames));
    }
    wanted.frames = static_cast<int>(*frames);
  }
  if (wanted.name.empty() || wanted.name.find('/') != std::string::npos || wanted.name.starts_with('.')) {
    return bad_input(fmt::format("--sequences {}: is no name of a sequence", internal::quoted(text)));
  }
  return wanted;
}

std::string joined(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ", ")); }

/// Names of the sequences whose poses lie in a folder.
std::vector<std::string> sequences_in(const fs::path& poses) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(poses, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() == ".txt") names.push_back(entry->path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string recorded_folder(const DriveOptions& options) {
  if (!options.clips.empty()) return options.clips;
  return options.use_images && !options.kitti.empty() ? (fs::path(options.kitti) / "sequences").string() : "";
}

std::vector<std::string> all_names(const DriveOptions& options) {
  if (!options.clips.empty()) return recorded_in(options.clips);
  if (!options.kitti.empty()) return sequences_in(fs::path(options.kitti) / "poses");
  std::vector<std::string> names;
  for (const std::string_view route : route_names()) names.emplace_back(route);
  return names;
}

std::vector<std::string> wanted_names(const DriveOptions& options) {
  if (options.sequences == std::vector<std::string>{"all"}) return all_names(options);
  if (!options.sequences.empty()) return options.sequences;
  const std::string recorded = recorded_folder(options);
  std::vector<std::string> present = recorded.empty() ? std::vector<std::string>() : recorded_in(recorded);
  if (!present.empty()) return present;
  return options.kitti.empty() ? all_names(options) : options.default_sequences;
}

Result<std::vector<Wanted>> wanted_drives(const DriveOptions& options) {
  std::vector<Wanted> all;
  for (const std::string& text : wanted_names(options)) {
    auto wanted = parse_wanted(text);
    if (!wanted) return wanted.error();
    if (options.frames) wanted->frames = std::min(wanted->frames, *options.frames);
    const auto same = [&](const Wanted& other) { return other.name == wanted->name; };
    if (std::any_of(all.begin(), all.end(), same)) {
      return bad_input(fmt::format("--sequences: '{}' is there twice", wanted->name));
    }
    all.push_back(std::move(*wanted));
  }
  if (!all.empty()) return all;
  if (options.clips.empty()) {
    return bad_input(fmt::format("--kitti {}: holds no poses/NN.txt (KITTI odometry's ground truth)", options.kitti));
  }
  return bad_input(fmt::format("--clips {}: holds no NN/image_0", options.clips));
}

Result<DriveChoice> along_poses(const Wanted& wanted, const fs::path& kitti) {
  const std::vector<std::string> known = sequences_in(kitti / "poses");
  if (known.empty()) {
    return bad_input(fmt::format("--kitti {}: holds no poses/NN.txt (KITTI odometry's ground truth)", kitti.string()));
  }
  if (std::find(known.begin(), known.end(), wanted.name) == known.end()) {
    return bad_input(
        fmt::format("'{}' is no sequence of --kitti {}, there are: {}", wanted.name, kitti.string(), joined(known)));
  }
  DriveChoice drive;
  drive.name = wanted.name;
  drive.poses = (kitti / "poses" / (wanted.name + ".txt")).string();
  const auto trajectory = read_trajectory(drive.poses);
  if (!trajectory) return trajectory.error();
  if (trajectory->size() < kMinFrames) {
    return bad_input(fmt::format("{}: {} poses, at least {} are needed", drive.poses, trajectory->size(), kMinFrames));
  }
  drive.frames = std::min(wanted.frames, static_cast<int>(trajectory->size()));
  std::error_code ignored;
  for (const fs::path& times :
       {kitti / "times" / (wanted.name + ".txt"), kitti / "sequences" / wanted.name / "times.txt"}) {
    if (drive.times.empty() && fs::is_regular_file(times, ignored)) drive.times = times.string();
  }
  return drive;
}

Result<DriveChoice> from_clip(const Wanted& wanted, const DriveOptions& options) {
  const std::vector<std::string> known = recorded_in(options.clips);
  if (std::find(known.begin(), known.end(), wanted.name) == known.end()) {
    return bad_input(fmt::format("'{}' is no drive of --clips {}, there are: {}", wanted.name, options.clips,
                                 known.empty() ? "none" : joined(known)));
  }
  const fs::path folder = fs::path(options.clips) / wanted.name;
  auto choice = recorded_choice(wanted.name, folder.string(), (folder / "poses.txt").string());
  if (choice) choice->frames = std::min(choice->frames, wanted.frames);
  return choice;
}

/// Along the poses of `kitti`: the real drive where its images are there and wanted, else one to be rendered.
Result<DriveChoice> of_kitti(const Wanted& wanted, const DriveOptions& options) {
  auto choice = along_poses(wanted, options.kitti);
  if (!choice || !options.use_images) return choice;
  const std::vector<std::string> present = recorded_in(recorded_folder(options));
  if (std::find(present.begin(), present.end(), wanted.name) == present.end()) return choice;
  const std::string folder = (fs::path(recorded_folder(options)) / wanted.name).string();
  auto real = recorded_choice(wanted.name, folder, choice->poses);
  if (real) real->frames = choice->frames;
  return real;
}

Result<DriveChoice> along_route(const Wanted& wanted, double rate_hz) {
  const auto route = find_route(wanted.name);
  if (!route) return route.error();
  const auto frames = static_cast<int>(drive(*route, rate_hz, {}).size());
  DriveChoice choice;
  choice.name = choice.route = wanted.name;
  choice.frames = std::min(wanted.frames, frames);
  return choice;
}

}  // namespace

Result<std::vector<DriveChoice>> choose_drives(const DriveOptions& options) {
  if (!options.clips.empty() && !options.kitti.empty())
    return internal::bad_input("--clips and --kitti can't both be given");
  const auto camera = find_camera_preset(options.preset);
  if (!camera) return camera.error();
  const auto all = wanted_drives(options);
  if (!all) return all.error();
  std::vector<DriveChoice> drives;
  for (const Wanted& wanted : *all) {
    auto drive = !options.clips.empty()   ? from_clip(wanted, options)
                 : !options.kitti.empty() ? of_kitti(wanted, options)
                                          : along_route(wanted, camera->options.rate_hz);
    if (!drive) return drive.error();
    drives.push_back(std::move(*drive));
  }
  return drives;
}

std::vector<std::string> simulate_arguments(const DriveChoice& drive, const DriveOptions& options) {
  std::vector<std::string> arguments = {"simulate"};
  const auto add = [&arguments](const char* option, const std::string& value) {
    if (!value.empty()) arguments.insert(arguments.end(), {option, value});
  };
  add("--route", drive.route);
  add("--trajectory", drive.poses);
  add("--times", drive.times);
  add("--preset", options.preset);
  add("--camera", options.camera);
  add("--frames", fmt::to_string(drive.frames));
  if (options.seed) add("--seed", fmt::to_string(*options.seed));
  if (options.road_masks) arguments.emplace_back("--road-masks");
  if (options.depth) arguments.emplace_back("--depth");
  return arguments;
}

}  // namespace groundscale
