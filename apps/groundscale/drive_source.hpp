#pragma once

#include <optional>
#include <string>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/geometry/trajectory.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/road_masks.hpp"
#include "groundscale/io/sequence.hpp"
#include "groundscale/odometry/run_source.hpp"
#include "groundscale/odometry/run_writer.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11's
class App;
}

namespace groundscale {

/// What the commands that drive the odometry take alike.
struct SourceArguments {
  std::optional<std::string> source;
  std::optional<std::string> camera_file, road_masks;
  std::optional<double> camera_height_m;
  std::optional<int> kitti_image, start, frames, seed;
  std::string config_file;
  std::vector<std::string> assignments;
};

/// Adds them to a subcommand. `arguments` must outlive it.
void add_source_options(CLI::App& command, SourceArguments& arguments);
/// The same without SOURCE and --road-masks, which belong to one drive.
void add_drive_options(CLI::App& command, SourceArguments& arguments);

/// The file of --config, above it --set, above both the other arguments.
Result<RunConfig> read_config(const SourceArguments& arguments);

/// Images of a drive, two at least, decoded ahead on a thread.
Result<std::unique_ptr<Sequence>> open_drive(const RunSource& source);

/// A camera and where it and its height came from.
struct CameraChoice {
  CameraSetup setup;  ///< Its height is empty where nothing says it.
  std::string camera_from;
  std::string height_from;
};

/// The camera file that is named, else the one that lies with the images. The height: of --camera-height, else of the
/// configuration, else of the camera file, else that of KITTI's layout.
Result<CameraChoice> choose_camera(const SourceArguments& arguments, const RunSource& source, const Sequence& sequence);

/// The height of a camera that is chosen already.
Result<void> choose_height(const SourceArguments& arguments, const RunSource& source, const Sequence& sequence,
                           CameraChoice& choice);

/// A camera that has its height; where both came from goes into the summary, with a warning where the height is
/// unlikely. @return kBadInput where nothing says the height.
Result<CameraSetup> metric_camera(const SourceArguments& arguments, const RunSource& source, const Sequence& sequence,
                                  RunSummary& summary);

/// Found out before the work: a truth of all frames; an empty one where none is named.
Result<Trajectory> open_truth(const std::string& path, const Sequence& sequence);

/// Distance from the frame before; nothing without truth or for the first of all.
std::optional<double> true_step_m(const Trajectory& truth, int frame);

/// For config.yaml: what was left to be found is filled in.
std::string config_in_force(RunConfig config, const Sequence& sequence, const RunSummary& summary);

/// Nothing without a folder.
Result<std::optional<RoadMasks>> open_masks(const std::string& folder, const Sequence& sequence);

/// The frame's mask; where there is none that can be used the frame goes without, with a warning.
Image mask_of(const Frame& frame, const std::optional<RoadMasks>& masks, std::vector<std::string>& warnings);

}  // namespace groundscale
