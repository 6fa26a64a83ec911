#include "groundscale/experiments/recorded_drive.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "groundscale/experiments/work_unit.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::bad_input;

/// Where `run` finds the images of a folder; "" where there are none.
std::string image_folder(const fs::path& folder) {
  std::error_code ignored;
  for (int k = 0; k < 4; ++k) {
    const fs::path images = folder / fmt::format("image_{}", k);
    if (fs::is_directory(images, ignored)) return images.string();
  }
  return "";
}

std::string image_of(const std::string& folder, int frame) {
  return (fs::path(image_folder(folder)) / fmt::format("{:06d}.png", frame)).string();
}

}  // namespace

std::vector<std::string> recorded_in(const std::string& parent) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(parent, error), end; !error && entry != end; entry.increment(error)) {
    if (!image_folder(entry->path()).empty()) names.push_back(entry->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

Result<DriveChoice> recorded_choice(const std::string& name, const std::string& folder, const std::string& truth) {
  constexpr int kMinFrames = 2;
  const auto trajectory = read_trajectory(truth);
  if (!trajectory) return trajectory.error();
  if (trajectory->size() < kMinFrames) {
    return bad_input(fmt::format("{}: {} poses, at least {} are needed", truth, trajectory->size(), kMinFrames));
  }
  const std::string last = image_of(folder, trajectory->size() - 1);
  std::error_code ignored;
  if (!fs::is_regular_file(last, ignored)) {
    return bad_input(fmt::format("{}: there is no {}, the image of the last of {} poses in {}", folder,
                                 fs::path(last).filename().string(), trajectory->size(), truth));
  }
  return DriveChoice{.name = name, .poses = truth, .recorded = folder, .frames = trajectory->size()};
}

Result<RenderedDrive> recorded_drive(const DriveChoice& choice) {
  const fs::path folder = choice.recorded;
  RenderedDrive drive{.name = choice.name, .folder = choice.recorded};
  drive.truth_file = choice.poses;
  drive.frames = choice.frames;
  std::error_code ignored;
  drive.real = !fs::exists(folder / "simulation.yaml", ignored);
  drive.key = fmt::format("recorded, {} frames", choice.frames);
  for (const std::string& file : {choice.poses, image_of(choice.recorded, choice.frames - 1)}) {
    const auto digest = file_digest(file);
    if (!digest) return digest.error();
    drive.key += ", " + *digest;
  }
  for (const char* file : {"camera.yaml", "calib.txt", "times.txt", "config.yaml"}) {
    if (const auto digest = file_digest((folder / file).string())) drive.key += fmt::format(", {} {}", file, *digest);
  }
  drive.key += "\n";
  return drive;
}

}  // namespace groundscale
