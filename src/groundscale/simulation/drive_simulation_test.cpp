#include "groundscale/simulation/drive_simulation.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/geometry/ground_plane.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

SimulatedCamera small_camera() {
  SimulatedCamera camera = find_camera_preset("small").value();
  camera.shutter_s = 0.0;
  return camera;
}

constexpr int kFrames = 40;

TEST(Presets, AnUnknownNameListsTheKnownOnes) {
  const auto preset = find_camera_preset("large");
  ASSERT_FALSE(preset);
  EXPECT_EQ(preset.error().message, "'large' is no preset, known: kitti, small");
}

TEST(TruthOfDrive, OnALevelFlatRoadThePlaneIsTheRoadItself) {
  WorldOptions options = WorldOptions::bare();
  options.profile.crown = 0.0;
  SimulatedCamera camera = small_camera();
  camera.rig.mounting = {0.02, -0.01, 0.03};
  const Route route{Path::of_pieces({{200.0, 0.0}}, {}), 10.0, {}, 0.0};
  const World world = make_world(route.path, options);
  for (const FrameTruth& frame : truth_of_drive(world, route, camera, kFrames, 3)) {
    const Eigen::Vector3d down = frame.world_from_cam.rotation.transpose() * Eigen::Vector3d::UnitY();
    EXPECT_LT((frame.plane.normal_in_cam - down).norm(), 1e-9);
    EXPECT_NEAR(frame.plane.height, -frame.world_from_cam.translation.y(), 1e-9);
    EXPECT_NEAR(frame.height_m, frame.plane.height, 1e-9);
    EXPECT_NEAR(frame.height_m, 1.65, 6.0 * camera.rig.bounce_sd_m);
  }
}

TEST(TruthOfDrive, ItsHomographyMapsRoadToRoad) {
  // What is true of both frames' planes: points of the road, projected into both, are mapped onto each other.
  WorldOptions options = WorldOptions::bare();
  options.profile.crown = 0.0;
  const SimulatedCamera camera = small_camera();
  const Route route{Path::of_pieces(turn_pieces(1.2, 15.0, 8.0), {}), 7.0, {}, 0.0};
  const World world = make_world(route.path, options);
  const auto frames = truth_of_drive(world, route, camera, 12, 3);
  const RigidTransform cam2_from_cam1 = frames[9].world_from_cam.inverse() * frames[8].world_from_cam;
  const Eigen::Matrix3d homography = homography_of_plane(frames[8].plane, cam2_from_cam1);
  for (const double z : {5.0, 9.0, 14.0}) {
    const Eigen::Vector3d ahead(0.3, 0.0, z);
    // Down to the road along world y.
    Eigen::Vector3d place = frames[8].world_from_cam * ahead;
    place.y() = world.surface.ground_y(place.x(), place.z());
    const auto pixel1 = camera.camera->project(frames[8].world_from_cam.inverse() * place);
    const auto pixel2 = camera.camera->project(frames[9].world_from_cam.inverse() * place);
    ASSERT_TRUE(pixel1 && pixel2);
    const auto mapped = camera.camera->project(homography * *camera.camera->ray(*pixel1));
    ASSERT_TRUE(mapped);
    EXPECT_LT((*mapped - *pixel2).norm(), 1e-6);
  }
}

TEST(Render, RoadPixelsLieWhereTheTruthSays) {
  // Texture seen in one frame is where the homography of the truth says in the next: rendered light agrees.
  WorldOptions options = WorldOptions::bare();
  options.profile.crown = 0.0;
  options.asphalt.grain = 0.0;  // stains alone are smooth enough to be compared between pixels
  SimulatedCamera camera = small_camera();
  camera.quality.samples = 4;
  const Route route{Path::of_pieces({{100.0, 0.0}}, {}), 4.0, {}, 0.0};
  const World world = make_world(route.path, options);
  const auto frames = truth_of_drive(world, route, camera, 6, 3);
  const Radiance first = render(world, *camera.camera, frames[4].shutter, camera.quality);
  const Radiance second = render(world, *camera.camera, frames[5].shutter, camera.quality);
  const Eigen::Matrix3d homography =
      homography_of_plane(frames[4].plane, frames[5].world_from_cam.inverse() * frames[4].world_from_cam);
  const auto value = [](const Radiance& image, double x, double y) {
    const auto column = static_cast<std::size_t>(std::lround(x));
    const auto row = static_cast<std::size_t>(std::lround(y));
    return image.values[row * static_cast<std::size_t>(image.width) + column];
  };
  double squares_moved = 0.0;
  double squares_unmoved = 0.0;
  for (int y = 120; y < 160; y += 3) {
    for (int x = 200; x < 280; x += 3) {
      const auto mapped = camera.camera->project(homography * *camera.camera->ray({x, y}));
      if (!mapped || mapped->y() > 198.0) continue;
      squares_moved += std::pow(value(first, x, y) - value(second, mapped->x(), mapped->y()), 2);
      squares_unmoved += std::pow(value(first, x, y) - value(second, x, y), 2);
    }
  }
  EXPECT_LT(squares_moved, 0.25 * squares_unmoved);
}

TEST(Render, IsTheSameWithAnyNumberOfThreads) {
  SimulatedCamera camera = find_camera_preset("small").value();
  const Route route = find_route("city").value();
  const World world = make_world(route.path, {});
  const auto frames = truth_of_drive(world, route, camera, 2, 1);
  const Radiance one = render(world, *camera.camera, frames[1].shutter, camera.quality);
  camera.quality.threads = 3;
  EXPECT_EQ(render(world, *camera.camera, frames[1].shutter, camera.quality).values, one.values);
}

}  // namespace
}  // namespace groundscale
