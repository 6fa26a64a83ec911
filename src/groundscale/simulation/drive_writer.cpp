#include "groundscale/simulation/drive_writer.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/core/hash.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/config.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/image_file.hpp"
#include "groundscale/io/trajectory_file.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

std::string options_text(const SimulatedDrive& drive) {
  SimulationOptions options = drive.camera.options;
  return to_yaml([&options](FieldVisitor& visitor) { visit_fields(options, visitor); });
}

void add(Fnv1a& hash, const Eigen::Vector3d& v) {
  for (const double value : v) hash.add(value);
}

void add(Fnv1a& hash, const RigidTransform& pose) {
  for (const double value : pose.rotation.reshaped()) hash.add(value);
  add(hash, pose.translation);
}

/// Folders of a drive that hold an image a frame.
constexpr const char* kImageFolders[] = {"image_0", "depth", "road_masks"};

std::string image_name(std::size_t frame) { return fmt::format("{:06d}.png", frame); }

/// The images of a drive, from where they were kept or rendered anew; in any order, quickest in that of the frames.
class DriveImages {
 public:
  DriveImages(const SimulatedDrive& drive, std::size_t frames, const DriveOutput& output)
      : drive_(drive),
        frames_(frames),
        ahead_(output.threads > 1),
        renderer_(drive.world, drive.camera.camera,
                  {.edge_rays = drive.camera.options.edge_rays, .threads = output.threads}),
        exposure_(drive.camera.options.sensor) {
    if (!output.cache_folder.empty()) kept_ = output.cache_folder + "/" + drive_key(drive);
    if (drive.camera.options.traffic.on) {
      traffic_.emplace(drive.world.surface, states_of(drive.moments), drive.camera.options.traffic, drive.seed);
    }
  }

  /// Bytes of a PNG.
  Result<std::string> image(std::size_t frame) {
    if (auto bytes = kept(frame)) return std::move(*bytes);
    const Radiance light = take_light(frame);
    // A generator of its own for each frame, so that none depends on which were rendered before.
    Rng rng(drive_.seed + 0x9e3779b97f4a7c15ULL * (frame + 1));
    auto bytes = encode_image(expose(light, gain(frame), drive_.camera.options.sensor, rng), ".png");
    if (bytes) keep(frame, *bytes);
    return bytes;
  }

  Result<std::string> depth(std::size_t frame) const {
    const Camera& camera = *drive_.camera.camera;
    const auto moving = moving_at(frame);
    const auto depths = renderer_.depth(drive_.moments[frame].world_from_cam, pointer(moving));
    return encode_depth(depths, camera.width(), camera.height());
  }

  Result<std::string> road_mask(std::size_t frame) const {
    const auto moving = moving_at(frame);
    return encode_image(renderer_.road_mask(drive_.moments[frame].world_from_cam, pointer(moving)), ".png");
  }

 private:
  static std::vector<VehicleState> states_of(const std::vector<CameraMoment>& moments) {
    std::vector<VehicleState> states;
    for (const CameraMoment& moment : moments) {
      states.push_back({moment.time_s, moment.distance_m, moment.speed_mps, 0.0});
    }
    return states;
  }

  Radiance render(std::size_t frame) const {
    const auto moving = moving_at(frame);
    return renderer_.render(drive_.moments[frame].shutter, pointer(moving));
  }

  /// The frame's light, and the next one's is begun: the processors have something to do while this one is exposed,
  /// encoded and written.
  Radiance take_light(std::size_t frame) {
    Radiance light = coming_.valid() && coming_frame_ == frame ? coming_.get() : render(frame);
    coming_frame_ = frame + 1;
    std::error_code ignored;
    const bool wanted =
        coming_frame_ < frames_ && (kept_.empty() || !fs::exists(kept_ + "/" + image_name(frame + 1), ignored));
    if (ahead_ && wanted) {
      coming_ = std::async(std::launch::async, [this, next = coming_frame_] { return render(next); });
    }
    return light;
  }

  std::optional<RayScene> moving_at(std::size_t frame) const {
    if (!traffic_) return std::nullopt;
    return RayScene(traffic_->at(drive_.moments[frame].time_s));
  }
  static const RayScene* pointer(const std::optional<RayScene>& scene) { return scene ? &*scene : nullptr; }

  /// The exposure depends on all frames before.
  double gain(std::size_t frame) {
    for (; metered_ <= frame; ++metered_) {
      const CameraMoment& moment = drive_.moments[metered_];
      const double dt_s = metered_ == 0 ? 0.0 : moment.time_s - drive_.moments[metered_ - 1].time_s;
      const auto moving = moving_at(metered_);
      gain_ = exposure_.follow(renderer_.mean_light(moment.shutter, pointer(moving)), dt_s);
    }
    return gain_;
  }

  /// Only what is an image of this camera: a file that has lost its end is none.
  std::optional<std::string> kept(std::size_t frame) const {
    if (kept_.empty()) return std::nullopt;
    const std::string path = kept_ + "/" + image_name(frame);
    const Camera& camera = *drive_.camera.camera;
    const auto image = read_image(path);
    if (!image || image->width() != camera.width() || image->height() != camera.height()) return std::nullopt;
    auto bytes = read_text(path);
    if (!bytes) return std::nullopt;
    return std::move(*bytes);
  }

  /// What can't be kept is rendered again the next time.
  void keep(std::size_t frame, const std::string& bytes) {
    if (kept_.empty() || !keeping_) return;
    std::error_code error;
    fs::create_directories(kept_, error);
    keeping_ = !error && write_text(kept_ + "/" + image_name(frame), bytes);
  }

  const SimulatedDrive& drive_;
  std::size_t frames_;
  bool ahead_;  ///< Render a frame while the one before is written.
  Renderer renderer_;
  Exposure exposure_;
  std::optional<Traffic> traffic_;
  std::string kept_;  ///< Folder; empty: nothing is kept.
  bool keeping_ = true;
  std::size_t metered_ = 0;
  double gain_ = 0.0;
  std::size_t coming_frame_ = 0;
  std::future<Radiance> coming_;  ///< Last, so that it ends before what it uses.
};

/// The files with a row a frame.
class DriveRows {
 public:
  static Result<DriveRows> create(const std::string& folder) {
    DriveRows rows;
    for (const char* name : {"poses.txt", "times.txt", "truth.csv"}) {
      auto writer = LineWriter::create(folder + "/" + name);
      if (!writer) return writer.error();
      rows.writers_.push_back(std::move(*writer));
    }
    const auto header =
        rows.writers_.back().write("frame,height_m,plane_height_m,normal_x,normal_y,normal_z,speed_mps");
    if (!header) return header.error();
    return rows;
  }

  /// All rows of a frame or none.
  Result<void> add(const std::array<std::string, 3>& texts) {
    for (std::size_t k = 0; k < texts.size(); ++k) {
      auto done = writers_[k].write(texts[k]);
      if (done) continue;
      for (std::size_t before = 0; before < k; ++before) writers_[before].take_back();
      return done;
    }
    return {};
  }

 private:
  DriveRows() = default;
  std::vector<LineWriter> writers_;
};

std::array<std::string, 3> rows_of(const SimulatedDrive& drive, std::size_t frame) {
  const CameraMoment& moment = drive.moments[frame];
  const RoadTruth truth = road_truth(drive, frame);
  const Eigen::Vector3d& n = truth.plane.normal_in_cam;
  const std::string plane =
      truth.has_plane ? fmt::format("{:.6f},{:.9f},{:.9f},{:.9f}", truth.plane.height, n.x(), n.y(), n.z()) : ",,,";
  return {kitti_row(drive.moments.front().world_from_cam.inverse() * moment.world_from_cam),
          fmt::format("{:.6f}", moment.time_s),
          fmt::format("{},{:.6f},{},{:.6f}", frame, truth.height_m, plane, moment.speed_mps)};
}

Result<void> write_camera(const std::string& folder, const SimulatedDrive& drive) {
  const CameraRig& rig = drive.camera.options.rig;
  CameraSetup setup;
  setup.camera = drive.camera.camera;
  setup.height_m = rig.height_m;
  if (drive.mounted) {
    setup.pitch_rad = kRadPerDeg * rig.pitch_deg;
    setup.roll_rad = kRadPerDeg * rig.roll_deg;
    setup.yaw_rad = kRadPerDeg * rig.yaw_deg;
  }
  if (auto done = write_camera_file(folder + "/camera.yaml", setup); !done) return done;
  const auto* pinhole = dynamic_cast<const PinholeCamera*>(setup.camera.get());
  if (pinhole == nullptr) return {};
  const PinholeParameters& p = pinhole->parameters();
  return write_text(folder + "/calib.txt", fmt::format("P0: {} 0 {} 0 0 {} {} 0 0 0 1 0\n", p.fx, p.cx, p.fy, p.cy));
}

/// What belongs to the drive as a whole.
Result<void> write_head(const std::string& folder, const SimulatedDrive& drive, const std::string& source) {
  if (auto done = write_camera(folder, drive); !done) return done;
  const std::string text = fmt::format("# {}\n# world version {}\n{}", source, kWorldVersion, options_text(drive));
  if (auto done = write_text(folder + "/simulation.yaml", text); !done) return done;
  if (drive.camera.region_px.empty()) return {};
  return write_text(
      folder + "/config.yaml",
      fmt::format("# For run --config: where the road is in view.\nroad:\n  region:\n    polygon_px: [{}]\n",
                  fmt::join(drive.camera.region_px, ", ")));
}

/// NNNNNN.png
bool is_numbered(const std::string& name) {
  constexpr std::size_t kDigits = 6;
  return name.size() == kDigits + 4 && name.ends_with(".png") &&
         std::all_of(name.begin(), name.begin() + kDigits, [](char c) { return c >= '0' && c <= '9'; });
}

/// Removes what an earlier drive has left in the folder, so that nothing of it passes for this one's.
/// @return kBadInput where there are images that no simulation has made: they may be somebody's data.
Result<void> remove_earlier(const std::string& folder) {
  std::error_code ignored;
  const bool simulated = fs::exists(folder + "/simulation.yaml", ignored);
  for (const char* name : kImageFolders) {
    const std::string images = fmt::format("{}/{}", folder, name);
    if (!simulated && fs::exists(images, ignored) && !fs::is_empty(images, ignored)) {
      return Error{ErrorCode::kBadInput,
                   fmt::format("--output {}: {} in it holds what no simulation has made (there is no simulation.yaml); "
                               "another folder is needed",
                               folder, name)};
    }
  }
  if (!simulated) return {};
  for (const char* name : {"calib.txt", "config.yaml", "poses.txt", "times.txt", "truth.csv"}) {
    fs::remove(fmt::format("{}/{}", folder, name), ignored);
  }
  for (const char* name : kImageFolders) {
    const std::string images = fmt::format("{}/{}", folder, name);
    std::vector<fs::path> numbered;
    for (fs::directory_iterator entry(images, ignored), end; entry != end; entry.increment(ignored)) {
      if (is_numbered(entry->path().filename().string())) numbered.push_back(entry->path());
    }
    for (const fs::path& path : numbered) fs::remove(path, ignored);
    fs::remove(images, ignored);  // where it is empty
  }
  return {};
}

}  // namespace

std::string user_cache_folder() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && *cache != '\0') return std::string(cache) + "/groundscale/drives";
  const char* home = std::getenv("HOME");
  return home != nullptr && *home != '\0' ? std::string(home) + "/.cache/groundscale/drives" : "";
}

std::string drive_key(const SimulatedDrive& drive) {
  Fnv1a hash;
  // Embree's instruction set decides the last bits of what rays meet.
  hash.add(fmt::format("world {}, {}, seed {}, {} x {}\n", kWorldVersion, RayScene::instruction_set(), drive.seed,
                       drive.camera.camera->width(), drive.camera.camera->height()));
  hash.add(options_text(drive));
  // The camera by what it does: rays all over the image.
  const Camera& camera = *drive.camera.camera;
  constexpr int kStridePx = 8;
  for (int y = 0; y < camera.height(); y += kStridePx) {
    for (int x = 0; x < camera.width(); x += kStridePx) {
      add(hash, camera.ray({static_cast<double>(x), static_cast<double>(y)}).value_or(Eigen::Vector3d::Zero()));
    }
  }
  for (const Path& road : drive.world.surface.roads()) {
    for (double s = 0.0; s <= road.length_m(); s += 1.0) add(hash, road.at(s).position);
  }
  for (const CameraMoment& moment : drive.moments) {
    hash.add(moment.time_s);
    add(hash, moment.world_from_cam);
    add(hash, moment.shutter.world_from_cam_open);
    add(hash, moment.shutter.world_from_cam_close);
  }
  return hash.text();
}

namespace {

/// Folders of images, one or more a frame.
std::vector<std::string> image_folders(const DriveOutput& output) {
  std::vector<std::string> folders = {"image_0"};
  if (output.depth) folders.emplace_back("depth");
  if (output.road_masks) folders.emplace_back("road_masks");
  return folders;
}

/// Images, then rows, of a frame; all or nothing.
Result<void> add_frame(const DriveOutput& output, const SimulatedDrive& drive, std::size_t frame, DriveImages& images,
                       DriveRows& rows) {
  std::vector<std::pair<std::string, Result<std::string>>> bytes;
  bytes.emplace_back("image_0", images.image(frame));
  if (output.depth) bytes.emplace_back("depth", images.depth(frame));
  if (output.road_masks) bytes.emplace_back("road_masks", images.road_mask(frame));
  const auto path_of = [&](const std::string& name) {
    return fmt::format("{}/{}/{}", output.folder, name, image_name(frame));
  };
  Result<void> done;
  for (const auto& [name, image] : bytes) {
    if (done) done = image ? write_text(path_of(name), *image) : Result<void>(image.error());
  }
  if (done) done = rows.add(rows_of(drive, frame));
  if (done) return done;
  std::error_code ignored;
  for (const auto& [name, unused] : bytes) fs::remove(path_of(name), ignored);
  return done;
}

}  // namespace

Result<void> write_drive(const SimulatedDrive& drive, const DriveOutput& output, const std::string& source,
                         const std::function<void(int)>& progress) {
  const auto frames = output.frames > 0 ? static_cast<std::size_t>(output.frames) : drive.moments.size();
  if (frames > drive.moments.size()) {
    return Error{ErrorCode::kBadInput, fmt::format("--frames {}: the drive has {}", frames, drive.moments.size())};
  }
  if (auto free = check_output_folder("--output", output.folder, output.force); !free) return free;
  if (auto removed = remove_earlier(output.folder); !removed) return removed;
  if (auto done = make_output_folder("--output", output.folder); !done) return done;
  for (const std::string& name : image_folders(output)) {
    if (auto done = make_output_folder("--output", output.folder + "/" + name); !done) return done;
  }
  const auto stopped = [frames](const Error& error, std::size_t whole) {
    return Error{error.code, fmt::format("{} ({} of {} frames are written and whole)", error.message, whole, frames)};
  };
  if (auto done = write_head(output.folder, drive, source); !done) return stopped(done.error(), 0);
  auto rows = DriveRows::create(output.folder);
  if (!rows) return stopped(rows.error(), 0);
  DriveImages images(drive, frames, output);
  for (std::size_t k = 0; k < frames; ++k) {
    if (auto done = add_frame(output, drive, k, images, *rows); !done) return stopped(done.error(), k);
    progress(static_cast<int>(k) + 1);
  }
  return {};
}

}  // namespace groundscale
