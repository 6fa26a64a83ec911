#include <benchmark/benchmark.h>

#include <filesystem>
#include <string>
#include <vector>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/io/image_file.hpp"
#include "groundscale/motion/two_view.hpp"
#include "groundscale/odometry/pairwise.hpp"
#include "groundscale/plane/methods.hpp"
#include "groundscale/road/region.hpp"
#include "groundscale/road/road_matcher.hpp"
#include "groundscale/tracking/tracker.hpp"
#include "synthetic_drive.hpp"

namespace groundscale {
namespace {

constexpr int kFrames = 12;

/// A rendered street of KITTI's size, and what each stage hands to the next.
struct Stages {
  SyntheticDrive drive{.width = 1241, .height = 376, .focal_px = 718.0};
  CameraPtr camera =
      PinholeCamera::create({.fx = drive.focal_px, .fy = drive.focal_px, .cx = drive.cx(), .cy = drive.cy()},
                            drive.width, drive.height)
          .value();
  std::vector<Image> images;
  Matches matches;
  TwoViewMotion motion;
  GroundPlane road{Eigen::Vector3d::UnitY(), drive.camera_height_m};
  RoadWarp warp;
  Image region;
  RoadView view;
  Matches road_matches;
  OdometryOptions options;

  Stages() {
    use_one_thread();
    for (int k = 0; k < kFrames; ++k) images.push_back(drive.render(k * drive.step_m));
    Tracker tracker(options.tracking);
    tracker.advance(images[0], {});
    const std::vector<TrackPoint> first = tracker.points();
    tracker.advance(images[1], {});
    matches = match_by_id(first, tracker.points());
    Rng rng(0);
    motion = estimate_motion(ray_pairs(matches, *camera), camera->focal_px(), options.motion, rng);
    warp = {{motion.cam2_from_cam1.rotation, drive.step_m * motion.cam2_from_cam1.translation}, road};
    region = region_mask({}, road, *camera, options.road.region);
    view.image = images[0];
    RoadMatcher matcher(options.road.tracking);
    matcher.fill(view, region);
    road_matches = matcher.match(view, images[1], warp, true, *camera);
  }
};

const Stages& stages() {
  static const Stages instance;
  return instance;
}

void decoding(benchmark::State& state) {
  const std::string path = (std::filesystem::temp_directory_path() / "groundscale_benchmark.png").string();
  if (!write_image(path, stages().images[0])) {
    state.SkipWithError("the image can't be written");
    return;
  }
  for (auto _ : state) benchmark::DoNotOptimize(read_image(path));
  std::filesystem::remove(path);
}
BENCHMARK(decoding)->Unit(benchmark::kMillisecond);

void tracking(benchmark::State& state) {
  const Stages& s = stages();
  Tracker tracker(s.options.tracking);
  int k = 0;
  for (auto _ : state) {
    tracker.advance(s.images[static_cast<std::size_t>(k)], {});
    k = (k + 1) % kFrames;
  }
}
BENCHMARK(tracking)->Unit(benchmark::kMillisecond);

void two_view_motion(benchmark::State& state) {
  const Stages& s = stages();
  Rng rng(0);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        estimate_motion(ray_pairs(s.matches, *s.camera), s.camera->focal_px(), s.options.motion, rng));
  }
}
BENCHMARK(two_view_motion)->Unit(benchmark::kMillisecond);

void road_region(benchmark::State& state) {
  const Stages& s = stages();
  for (auto _ : state) benchmark::DoNotOptimize(region_mask({}, s.road, *s.camera, s.options.road.region));
}
BENCHMARK(road_region)->Unit(benchmark::kMillisecond);

void road_detection(benchmark::State& state) {
  const Stages& s = stages();
  RoadMatcher matcher(s.options.road.tracking);
  for (auto _ : state) {
    RoadView view{s.images[0], {}};
    matcher.fill(view, s.region);
    benchmark::DoNotOptimize(view);
  }
}
BENCHMARK(road_detection)->Unit(benchmark::kMillisecond);

void road_tracking(benchmark::State& state) {
  const Stages& s = stages();
  const RoadMatcher matcher(s.options.road.tracking);
  for (auto _ : state) benchmark::DoNotOptimize(matcher.match(s.view, s.images[1], s.warp, true, *s.camera));
}
BENCHMARK(road_tracking)->Unit(benchmark::kMillisecond);

void plane(benchmark::State& state) {
  const Stages& s = stages();
  RoadObservations observations;
  observations.camera = s.camera;
  observations.cam_from_reference = {RigidTransform{}, s.motion.cam2_from_cam1};
  for (const Match& match : s.road_matches) {
    observations.points.push_back({match.id, match.pixel1, {RoadSight{1, match.pixel2}}});
  }
  Rng rng(0);
  for (auto _ : state) benchmark::DoNotOptimize(estimate_plane_sparse(observations, s.options.ground.plane, rng));
}
BENCHMARK(plane)->Unit(benchmark::kMillisecond);

void whole_frame(benchmark::State& state) {
  const Stages& s = stages();
  CameraSetup setup;
  setup.camera = s.camera;
  setup.height_m = s.drive.camera_height_m;
  auto odometry = PairwiseOdometry::create(setup, s.options);
  int k = 0;
  for (auto _ : state) {
    if (k == kFrames) {  // from the beginning, so that the drive never jumps
      state.PauseTiming();
      odometry = PairwiseOdometry::create(setup, s.options);
      k = 0;
      state.ResumeTiming();
    }
    odometry->advance({k, 0.1 * k, s.images[static_cast<std::size_t>(k)], ""});
    ++k;
  }
}
BENCHMARK(whole_frame)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace groundscale
