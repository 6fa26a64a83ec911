#pragma once

#include <optional>
#include <string>
#include <vector>

#include "groundscale/core/result.hpp"

namespace groundscale {

/// Which drives an experiment is to work on: simulated ones, unless `clips` or `use_images` say otherwise.
struct DriveOptions {
  /// Folder with KITTI odometry's `poses/NN.txt` and `times/NN.txt` or `sequences/NN/times.txt`; "": built-in routes.
  std::string kitti;
  bool use_images = false;  ///< Sequences of `kitti` whose images lie in `sequences/NN` are real drives.
  /// Folder with a real drive a sequence, `NN/image_0` and `NN/poses.txt`, instead of `kitti`.
  std::string clips;
  /// NAME or NAME:FRAMES, a sequence (of a route, where there is no `kitti`), or `all`. Empty: the real drives where
  /// there are any, else `default_sequences`, or all routes.
  std::vector<std::string> sequences;
  std::vector<std::string> default_sequences = {"06", "07", "10", "00:1501"};  ///< Of those along `kitti`.
  std::optional<int> frames;                                                   ///< At most so many of each drive.
  std::string preset = "kitti";                                                ///< Camera and its place on the vehicle.
  std::string camera;       ///< Camera file instead of the preset's camera; "": none.
  std::optional<int> seed;  ///< Of world, vehicle and sensor.
  bool road_masks = false;  ///< Simulated drives have masks of the road besides,
  bool depth = false;       ///< and depths.
  int threads = 0;          ///< For rendering, which is the same with any number; 0: one a processor.
};

/// One of them.
struct DriveChoice {
  std::string name;        ///< "06", "city"
  std::string route{};     ///< Built-in route; "" where it follows a pose file.
  std::string poses{};     ///< Pose file; "" on a built-in route.
  std::string times{};     ///< Its times; "" where there are none.
  std::string recorded{};  ///< Folder of a real drive, whose truth `poses` is; "" where it is to be rendered.
  int frames = 0;          ///< All that are wanted.
};

/// Looks at everything that can be wrong with the options before any work.
/// @return kBadInput: `clips` and `kitti` both; no such preset, route or sequence (those that are there are listed); a
/// name twice; a pose file that can't be read; a number of frames that is none or below 2; a real drive that misses
/// something.
Result<std::vector<DriveChoice>> choose_drives(const DriveOptions& options);

/// Arguments of `groundscale simulate` that decide what the drive is, --output and --threads left out.
std::vector<std::string> simulate_arguments(const DriveChoice& drive, const DriveOptions& options);

}  // namespace groundscale
