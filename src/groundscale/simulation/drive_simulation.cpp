#include "groundscale/simulation/drive_simulation.hpp"

#include <cmath>
#include <numbers>
#include <string_view>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/image_file.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "groundscale/road/region.hpp"
#include "groundscale/simulation/named_internal.hpp"

namespace groundscale {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

CameraPtr pinhole(const PinholeParameters& parameters, int width, int height) {
  return PinholeCamera::create(parameters, width, height).value();
}

/// KITTI's left grey camera after rectification, with the distortion that is left in its images.
SimulatedCamera kitti() {
  SimulatedCamera camera;
  camera.camera = pinhole({.fx = 718.856,
                           .fy = 718.856,
                           .cx = 607.1928,
                           .cy = 185.2157,
                           .k1 = 0.0117,
                           .k2 = 0.0,
                           .p1 = 0.0,
                           .p2 = 0.0,
                           .k3 = 0.0},
                          1241, 376);
  camera.rig.mounting.pitch_rad = 0.8 * kRadPerDeg;
  return camera;
}

/// For tests: quick to render.
SimulatedCamera small() {
  SimulatedCamera camera;
  camera.camera = pinhole({.fx = 300.0, .fy = 300.0, .cx = 239.5, .cy = 60.0}, 480, 200);
  camera.quality = {.samples = 2, .edge_samples = 2, .threads = 1};
  return camera;
}

struct NamedPreset {
  std::string_view name;
  SimulatedCamera (*make)();
};
constexpr NamedPreset kPresets[] = {{"kitti", kitti}, {"small", small}};

/// Least squares plane, in the camera, of the road (no kerb, no pavement) in the default region, weighted as road
/// points are.
GroundPlane plane_ahead(const RoadSurface& surface, double distance_m, const RigidTransform& world_from_cam) {
  const RegionOptions region;
  constexpr double kAlongM = 0.5;
  constexpr double kAsideM = 0.25;
  const RigidTransform cam_from_world = world_from_cam.inverse();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sums = Eigen::Vector3d::Zero();
  for (double along = region.near_m; along <= region.far_m; along += kAlongM) {
    const PathPoint point = surface.path().at(distance_m + along);
    for (double aside = -region.half_width_m; aside <= region.half_width_m; aside += kAsideM) {
      Eigen::Vector3d place = point.position + aside * point.right();
      const RoadPlace on_ground = surface.locate(place.x(), place.z());
      if (on_ground.ground != Ground::kRoad) continue;
      place.y() = surface.ground_y(on_ground);
      const Eigen::Vector3d in_cam = cam_from_world * place;
      const double weight = std::exp(-0.5 * std::pow(aside / region.weight_sd_m, 2));
      // m . X = 1 with m = n / h.
      moments += weight * in_cam * in_cam.transpose();
      sums += weight * in_cam;
    }
  }
  const Eigen::Vector3d m = moments.ldlt().solve(sums);
  return {m.normalized(), 1.0 / m.norm()};
}

std::string truth_row(int frame, const FrameTruth& truth) {
  const Eigen::Vector3d& n = truth.plane.normal_in_cam;
  return fmt::format("{},{:.6f},{:.6f},{:.9f},{:.9f},{:.9f},{:.6f}", frame, truth.height_m, truth.plane.height, n.x(),
                     n.y(), n.z(), truth.speed_mps);
}

Result<void> write_calibration(const std::string& folder, const SimulatedCamera& simulated) {
  const CameraRig& rig = simulated.rig;
  CameraSetup setup;
  setup.camera = simulated.camera;
  setup.height_m = rig.height_m;
  setup.pitch_rad = rig.mounting.pitch_rad;
  setup.roll_rad = rig.mounting.roll_rad;
  setup.yaw_rad = rig.mounting.yaw_rad;
  if (auto done = write_camera_file(folder + "/camera.yaml", setup); !done) return done;
  const auto* pinhole = dynamic_cast<const PinholeCamera*>(simulated.camera.get());
  if (pinhole == nullptr) return {};
  const PinholeParameters& p = pinhole->parameters();
  return write_text(folder + "/calib.txt", fmt::format("P0: {} 0 {} 0 0 {} {} 0 0 0 1 0\n", p.fx, p.cx, p.fy, p.cy));
}

}  // namespace

Result<SimulatedCamera> find_camera_preset(std::string_view name) {
  return internal::make_named(kPresets, name, "preset");
}

std::vector<FrameTruth> truth_of_drive(const World& world, const Route& route, const SimulatedCamera& camera,
                                       int max_frames, std::uint64_t seed) {
  std::vector<VehicleState> states = drive(route, camera.rate_hz, {});
  if (static_cast<int>(states.size()) > max_frames) states.resize(static_cast<std::size_t>(max_frames));
  const auto shifted = [&states](double by_s) {
    std::vector<VehicleState> moved = states;
    for (VehicleState& state : moved) state.distance_m += by_s * state.speed_mps;
    return moved;
  };
  const double half = 0.5 * camera.shutter_s;
  const auto poses = camera_poses(world.surface, states, camera.rig, seed);
  const auto open = camera_poses(world.surface, shifted(-half), camera.rig, seed);
  const auto close = camera_poses(world.surface, shifted(half), camera.rig, seed);
  std::vector<FrameTruth> frames(states.size());
  for (std::size_t k = 0; k < states.size(); ++k) {
    FrameTruth& frame = frames[k];
    frame.time_s = states[k].time_s;
    frame.world_from_cam = poses[k];
    frame.shutter = {open[k], close[k]};
    frame.speed_mps = states[k].speed_mps;
    const RigidTransform rest = camera_at_rest(world.surface, states[k].distance_m, CameraRig{});
    const Eigen::Vector3d foot = world.surface.path().at(states[k].distance_m).position;
    frame.height_m = rest.rotation.col(1).dot(foot - poses[k].translation);
    frame.plane = plane_ahead(world.surface, states[k].distance_m, poses[k]);
  }
  return frames;
}

Result<void> write_drive(const World& world, const std::vector<FrameTruth>& frames, const SimulatedCamera& camera,
                         const DriveOutput& output, std::uint64_t seed, const std::function<void(int)>& progress) {
  if (auto free = check_output_folder("--output", output.folder, output.force); !free) return free;
  if (auto done = make_output_folder("--output", output.folder + "/image_0"); !done) return done;
  if (auto done = write_calibration(output.folder, camera); !done) return done;
  // All that is known beforehand first: a drive that ends early is a shorter drive, once its rows are cut.
  std::string times;
  std::string truth = "frame,height_m,plane_height_m,normal_x,normal_y,normal_z,speed_mps\n";
  Trajectory trajectory;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    times += fmt::format("{:.6f}\n", frames[k].time_s);
    truth += truth_row(static_cast<int>(k), frames[k]) + "\n";
    trajectory.world_from_cam.push_back(frames.front().world_from_cam.inverse() * frames[k].world_from_cam);
  }
  if (auto done = write_kitti(output.folder + "/poses.txt", trajectory); !done) return done;
  if (auto done = write_text(output.folder + "/truth.csv", truth); !done) return done;
  if (auto done = write_text(output.folder + "/times.txt", times); !done) return done;

  Rng rng(seed);
  Sensor sensor(camera.sensor, rng);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const Radiance light = render(world, *camera.camera, frames[k].shutter, camera.quality);
    const Image image = sensor.expose(light, 1.0 / camera.rate_hz);
    const auto written = write_image(fmt::format("{}/image_0/{:06d}.png", output.folder, k), image);
    if (!written) {
      return Error{written.error().code,
                   fmt::format("{} (after {} of {} frames)", written.error().message, k, frames.size())};
    }
    progress(static_cast<int>(k) + 1);
  }
  return {};
}

}  // namespace groundscale
