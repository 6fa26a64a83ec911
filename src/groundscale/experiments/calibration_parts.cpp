#include "groundscale/experiments/calibration_parts.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "groundscale/camera/kannala_brandt.hpp"
#include "groundscale/camera/parameters.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {
namespace {

/// How far starts are off: 0.02 of KITTI's k1 are 10 px in the corners.
constexpr double kRadial = 0.02;
constexpr double kRadialPx = 10.0;
constexpr double kRowPx = 5.0;

using Items = std::vector<CalibrationPart::Item>;

/// All that parts are made from.
struct Plan {
  const CalibrationTrialOptions& options;
  std::vector<TrialDrive> long_drives;  ///< `city`, then those along KITTI's poses; with KITTI's camera.
  std::string fisheye_camera;
};

CalibrationStart off_by(double radial, double row_px, double focal = 0.0,
                        FocalKnowledge known = FocalKnowledge::kGiven) {
  return {.radial = radial, .row_px = row_px, .focal = focal, .known = known};
}

Result<std::vector<TrialDrive>> choose(const DriveOptions& options) {
  auto choices = choose_drives(options);
  if (!choices) return choices.error();
  std::vector<TrialDrive> drives;
  for (DriveChoice& choice : *choices) drives.push_back({std::move(choice), options});
  return drives;
}

Result<std::vector<TrialDrive>> choose_long(const CalibrationTrialOptions& options) {
  DriveOptions route;
  route.sequences = {"city:600"};
  route.threads = options.threads;
  auto drives = choose(route);
  if (!drives || options.kitti.empty()) return drives;
  DriveOptions along;
  along.kitti = options.kitti;
  along.sequences = options.sequences;
  along.default_sequences = {"00:500", "05:500", "07:500"};
  along.threads = options.threads;
  const auto more = choose(along);
  if (!more) return more;
  drives->insert(drives->end(), more->begin(), more->end());
  return drives;
}

/// The beginning of a route, under a name of its own.
TrialDrive short_drive(const Plan& plan, const std::string& route, const std::string& name) {
  DriveOptions options;
  options.preset = plan.options.preset;
  options.threads = plan.options.threads;
  return {{.name = name, .route = route, .frames = plan.options.frames}, options};
}

/// Both signs of the errors in turn.
Items seeds(const Plan& plan) {
  Items items;
  for (int seed = 1; seed <= plan.options.seeds; ++seed) {
    TrialDrive drive = short_drive(plan, "city", fmt::format("city-{}-seed-{}", plan.options.preset, seed));
    drive.options.seed = seed;
    const double radial = seed % 2 == 0 ? kRadial : -kRadial;
    const double row_px = (seed / 2) % 2 == 0 ? kRowPx : -kRowPx;
    items.push_back({drive, {.start = off_by(radial, row_px)}});
  }
  return items;
}

Items drives(const Plan& plan) {
  Items items;
  for (const auto& [radial, row_px] : {std::pair(-kRadial, kRowPx), std::pair(kRadial, -kRowPx)}) {
    for (const TrialDrive& drive : plan.long_drives) items.push_back({drive, {.start = off_by(radial, row_px)}});
  }
  return items;
}

Items straight(const Plan& plan) {
  const TrialDrive drive = short_drive(plan, "straight", "straight-" + plan.options.preset);
  return {{drive, {.start = off_by(-kRadial, kRowPx)}}, {drive, {.start = off_by(kRadial, -kRowPx)}}};
}

CameraPtr fisheye_camera() {
  return KannalaBrandtCamera::create({.fx = 282.0,
                                      .fy = 282.0,
                                      .cx = 318.4,
                                      .cy = 197.3,
                                      .k1 = 0.012,
                                      .k2 = -0.004,
                                      .k3 = 0.001,
                                      .k4 = -0.0002},
                                     640, 400)
      .value();
}

Items fisheye(const Plan& plan) {
  TrialDrive drive = short_drive(plan, "city", "city-fisheye");
  drive.options.preset = "small";
  drive.options.camera = plan.fisheye_camera;
  const double radial = kRadialPx * pixel_step(CameraParameter::kRadial, *fisheye_camera());
  return {{drive, {.start = off_by(-radial, kRowPx)}}, {drive, {.start = off_by(radial, -kRowPx)}}};
}

Items focal(const Plan& plan) {
  Items items;
  const TrialDrive& city = plan.long_drives.front();
  const auto add = [&](const TrialDrive& drive, const CalibrationStart& start) {
    items.push_back({drive, {.start = start, .lengths = true}});
  };
  constexpr double kOff = 0.01, kViewOff = 0.1;
  for (const double error : {0.0, kOff, -kOff}) add(city, off_by(-kRadial, kRowPx, error));
  for (const TrialDrive& drive : plan.long_drives) add(drive, off_by(0, 0, 0, FocalKnowledge::kNothing));
  for (const double error : {kViewOff, -kViewOff}) add(city, off_by(0, 0, error, FocalKnowledge::kView));
  for (const double error : {kOff, -kOff}) add(city, off_by(-kRadial, kRowPx, error, FocalKnowledge::kWithSd));
  return items;
}

Items range(const Plan& plan) {
  Items items;
  const auto add = [&](const CalibrationStart& start) {
    items.push_back({plan.long_drives.front(), {.start = start, .frames = plan.options.frames}});
  };
  for (const double radial : {0.02, 0.05, 0.1, 0.2}) {
    for (const double sign : {-1.0, 1.0}) add(off_by(sign * radial, 0.0));
  }
  for (const double row_px : {5.0, 10.0, 20.0, 40.0}) {
    for (const double sign : {-1.0, 1.0}) add(off_by(0.0, sign * row_px));
  }
  for (const double error : {0.05, 0.1, 0.2}) {
    for (const double sign : {-1.0, 1.0}) add(off_by(0, 0, sign * error, FocalKnowledge::kView));
  }
  return items;
}

struct NamedPart {
  const char* name;
  const char* question;
  Items (*items)(const Plan& plan);
};

/// Every part.
constexpr NamedPart kParts[] = {
    {"seeds", "How honest the stated standard deviations are: the same short drive through other worlds.", seeds},
    {"drives", "How near it comes to the truth on longer drives with KITTI's camera.", drives},
    {"straight", "A drive without turns tells nothing: the calibration has to stay as it is.", straight},
    {"fisheye", "The same with a fisheye that looks ahead, 130 degrees wide (Kannala-Brandt).", fisheye},
    {"focal",
     "What another focal length does to the other parameters and to lengths, and how near it is found where nothing "
     "is known of it. Lengths against those that the true camera gives.",
     focal},
    {"range", "How far off the start may be.", range}};

}  // namespace

std::vector<std::string> calibration_part_names() {
  std::vector<std::string> names;
  for (const NamedPart& part : kParts) names.emplace_back(part.name);
  return names;
}

Result<std::vector<CalibrationPart>> plan_calibration_parts(const CalibrationTrialOptions& options,
                                                            const std::string& fisheye_camera) {
  DriveOptions check;
  check.preset = options.preset;
  check.sequences = {"city", "straight"};
  if (const auto known = choose_drives(check); !known) return known.error();
  auto long_drives = choose_long(options);
  if (!long_drives) return long_drives.error();
  const std::vector<std::string> names = calibration_part_names();
  for (const std::string& wanted : options.parts) {
    if (std::find(names.begin(), names.end(), wanted) != names.end()) continue;
    return internal::bad_input(
        fmt::format("--parts: {} is no part, known: {}", internal::quoted(wanted), fmt::join(names, ", ")));
  }
  const Plan plan{options, std::move(*long_drives), fisheye_camera};
  std::vector<CalibrationPart> parts;
  for (const NamedPart& part : kParts) {
    const auto& wanted = options.parts;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), part.name) == wanted.end()) continue;
    parts.push_back({part.name, part.question, part.items(plan)});
  }
  return parts;
}

Result<void> write_fisheye_camera(const std::string& path) {
  std::error_code ignored;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), ignored);
  CameraSetup setup;
  setup.camera = fisheye_camera();
  return write_camera_file(path, setup);
}

}  // namespace groundscale
