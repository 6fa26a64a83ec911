// Drives that the keyframe odometry must measure from beginning to end: traffic, halts and a tight turn, with and
// without black frames; 60 Hz; fisheyes.
#include <numbers>

#include "groundscale/camera/kannala_brandt.hpp"
#include "groundscale/camera/ocam.hpp"
#include "hard_drive.hpp"

namespace groundscale {
namespace {

constexpr double kLength = 0.03;  // as in keyframe_hard_test.cpp

/// 68 m with oncoming traffic: a halt at the start, one after 24 m, a right turn of 6.5 m radius at 13 km/h.
struct Town {
  CameraPreset camera;
  SimulatedDrive drive;
  Feed feed;

  /// The first frame that lies so far along the road.
  std::size_t at(double distance_m) const {
    std::size_t k = 0;
    while (drive.moments[k].distance_m < distance_m) ++k;
    return k;
  }
};

const Town& town() {
  static const Town made = [] {
    CameraPreset camera = find_camera_preset("small").value();
    camera.options.traffic.on = true;
    camera.options.traffic.oncoming_every_s = 3.0;
    std::vector<PathPiece> pieces{{32.0, 0.0}};
    for (const PathPiece& piece : turn_pieces(0.5 * std::numbers::pi, 6.5, 4.0)) pieces.push_back(piece);
    pieces.push_back({14.0, 0.0});
    const Route route{Path::of_pieces(pieces, {}), Surroundings::kTown, 7.0, {0.1, 24.0}, 3.0};
    SimulatedDrive drive = drive_along(route, camera, 5);
    Feed feed = rendered(drive);
    return Town{camera, std::move(drive), std::move(feed)};
  }();
  return made;
}

Feed dark(const Feed& feed, std::size_t from) {
  Feed result = feed;
  for (std::size_t k = from; k < from + 10; ++k) {
    result[k].image = with_noise(Image(feed[k].image.width(), feed[k].image.height()), k);
  }
  return result;
}

TEST(KeyframeDrives, ATownWithTrafficHaltsAndATightTurn) {
  const Feed& feed = town().feed;
  const DriveRun result = run(feed, setup_of(town().camera));
  expect_whole(result, feed);
  const std::size_t last = feed.size() - 1;
  EXPECT_NEAR(length_ratio(result, feed, 0, last), 1.0, kLength);
  EXPECT_NEAR(length_ratio(result, feed, town().at(30.0), last), 1.0, kLength);  // the turn
  EXPECT_LT(motion_error_m(result, feed, town().at(30.0), last), 0.4);
  // Halts add nothing, with cars passing: the frames between those at which it has come to rest and starts again.
  for (std::size_t k = 1; k < feed.size(); ++k) {
    if (town().drive.moments[k].speed_mps > 0.0 || town().drive.moments[k - 1].speed_mps > 0.0) continue;
    EXPECT_LT(result.results[k].step_m, 0.03) << k;
  }
  const std::size_t halt = town().at(23.99);
  EXPECT_LT(length_of(result.finals, halt + 2, halt + 28), 0.01);
}

TEST(KeyframeDrives, BlackFramesAtLowSpeedAndTheMapIsFoundAgain) {
  // The last second before a halt: only the map can tell how the vehicle has braked.
  const std::size_t from = town().at(23.99) - 12;
  const Feed feed = dark(town().feed, from);
  const DriveRun result = run(feed, setup_of(town().camera));
  expect_whole(result, feed);
  // At its speed before it would have gone 1.2 m too far by then.
  EXPECT_LT(motion_error_m(result, feed, from - 1, from + 12), 0.2);
  for (std::size_t k = from + 12; k < feed.size(); ++k) {
    EXPECT_NE(result.results[k].state, FrameState::kBridged) << k;
    EXPECT_NE(result.results[k].state, FrameState::kLost) << k;
  }
  EXPECT_NEAR(length_ratio(result, feed, from + 10, feed.size() - 1), 1.0, kLength);
}

TEST(KeyframeDrives, BlackFramesInATightTurn) {
  const std::size_t from = town().at(40.0);
  const Feed feed = dark(town().feed, from);
  const DriveRun result = run(feed, setup_of(town().camera));
  expect_whole(result, feed);
  EXPECT_NEAR(length_ratio(result, feed, from + 10, feed.size() - 1), 1.0, kLength);
}

TEST(KeyframeDrives, SixtyHertz) {
  CameraPreset camera = find_camera_preset("small").value();
  camera.options.rate_hz = 60.0;
  const Route route{Path::of_pieces({{15.0, 0.0}, {10.0, 0.01}, {60.0, 0.01}}, {}), Surroundings::kTown, 10.0, {}, 0.0};
  const Feed feed = rendered(drive_along(route, camera, 4), 150);
  const DriveRun result = run(feed, setup_of(camera));
  expect_whole(result, feed);
  EXPECT_NEAR(length_ratio(result, feed, 0, feed.size() - 1), 1.0, kLength);
  EXPECT_LT(motion_error_m(result, feed, 0, feed.size() - 1), 0.75);
  EXPECT_GT(accepted_in(result, 0, feed.size() - 1), 100U);
}

TEST(KeyframeDrives, AFisheye) {
  CameraPreset camera = find_camera_preset("small").value();
  camera.camera = KannalaBrandtCamera::create(
                      {.fx = 220.0, .fy = 220.0, .cx = 319.5, .cy = 150.0, .k1 = -0.02, .k2 = 0.003}, 640, 330)
                      .value();
  const Route route{Path::of_pieces({{15.0, 0.0}, {10.0, 0.01}, {60.0, 0.01}}, {}), Surroundings::kTown, 10.0, {}, 0.0};
  const Feed feed = rendered(drive_along(route, camera, 4), 60);
  const DriveRun result = run(feed, setup_of(camera));
  expect_whole(result, feed);
  EXPECT_NEAR(length_ratio(result, feed, 0, feed.size() - 1), 1.0, kLength);
  EXPECT_LT(motion_error_m(result, feed, 0, feed.size() - 1), 1.0);
}

TEST(KeyframeDrives, AnOcamThatLooksToTheSide) {
  // The campus preset at a third of its size.
  CameraPreset camera = find_camera_preset("campus").value();
  const OcamParameters lens{.polynomial = {-170.0, 0.0, 3.0 * 4.9e-4, -9.0 * 2.0e-8, 27.0 * 2.0e-11},
                            .cx = 320.1,
                            .cy = 179.2,
                            .c = 1.0003,
                            .d = -2e-4,
                            .e = 3e-4};
  camera.camera = OcamCamera::create(lens, 640, 360).value();
  camera.options.edge_rays = 0;
  for (double& pixel : camera.region_px) pixel /= 3.0;
  const Route route{Path::of_pieces({{15.0, 0.0}, {10.0, 0.01}, {60.0, 0.01}}, {}), Surroundings::kTown, 8.0, {}, 0.0};
  const Feed feed = rendered(drive_along(route, camera, 4), 60);
  OdometryOptions options;
  options.road.region.polygon_px = camera.region_px;
  const DriveRun result = run(feed, setup_of(camera), options);
  expect_whole(result, feed);
  EXPECT_NEAR(length_ratio(result, feed, 0, feed.size() - 1), 1.0, kLength);
  EXPECT_LT(motion_error_m(result, feed, 0, feed.size() - 1), 0.3);
}

}  // namespace
}  // namespace groundscale
