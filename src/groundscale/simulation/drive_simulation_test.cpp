#include "groundscale/simulation/drive_simulation.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/geometry/ground_plane.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

/// A small camera without motion blur in a bare world on a flat road.
CameraPreset small_camera() {
  CameraPreset camera = find_camera_preset("small").value();
  camera.options.shutter_ms = 0.0;
  camera.options.world = WorldOptions::bare();
  camera.options.world.profile.crown = 0.0;
  camera.options.world.profile.roughness_m = 0.0;
  return camera;
}

Route plain_route(const std::vector<PathPiece>& pieces, double speed_mps) {
  return {Path::of_pieces(pieces, {}), Surroundings::kTown, speed_mps, {}, 0.0};
}

TEST(Presets, AnUnknownNameListsTheKnownOnes) {
  const auto preset = find_camera_preset("large");
  ASSERT_FALSE(preset);
  EXPECT_EQ(preset.error().message, "'large' is no preset, known: kitti, campus, small");
}

TEST(RoadTruth, OnALevelFlatRoadThePlaneIsTheRoadItself) {
  CameraPreset camera = small_camera();
  CameraRig& rig = camera.options.rig;
  rig.pitch_deg = 1.1;
  rig.roll_deg = -0.6;
  rig.yaw_deg = 1.7;
  const SimulatedDrive drive = drive_along(plain_route({{200.0, 0.0}}, 10.0), camera, 3);
  ASSERT_GT(drive.moments.size(), 100U);
  for (std::size_t k = 0; k < 100; k += 3) {
    const RigidTransform& pose = drive.moments[k].world_from_cam;
    const RoadTruth truth = road_truth(drive, k);
    const Eigen::Vector3d down = pose.rotation.transpose() * Eigen::Vector3d::UnitY();
    EXPECT_LT((truth.plane.normal_in_cam - down).norm(), 1e-9);
    EXPECT_NEAR(truth.plane.height, -pose.translation.y(), 1e-9);
    EXPECT_NEAR(truth.height_m, truth.plane.height, 1e-9);
    EXPECT_NEAR(truth.height_m, 1.65, 6.0 * rig.bounce_sd_m);
  }
}

TEST(RoadTruth, ItsHomographyMapsRoadToRoad) {
  // What is true of both frames' planes: points of the road, projected into both, are mapped onto each other.
  const CameraPreset preset = small_camera();
  const SimulatedDrive drive = drive_along(plain_route(turn_pieces(1.2, 15.0, 8.0), 7.0), preset, 3);
  const RigidTransform& first = drive.moments[8].world_from_cam;
  const RigidTransform& second = drive.moments[9].world_from_cam;
  const Eigen::Matrix3d homography = homography_of_plane(road_truth(drive, 8).plane, second.inverse() * first);
  for (const double z : {5.0, 9.0, 14.0}) {
    // Down to the road along world y.
    Eigen::Vector3d place = first * Eigen::Vector3d(0.3, 0.0, z);
    place.y() = drive.world.surface.ground_y(place.x(), place.z());
    const auto pixel1 = preset.camera->project(first.inverse() * place);
    const auto pixel2 = preset.camera->project(second.inverse() * place);
    ASSERT_TRUE(pixel1 && pixel2);
    const auto mapped = preset.camera->project(homography * *preset.camera->ray(*pixel1));
    ASSERT_TRUE(mapped);
    EXPECT_LT((*mapped - *pixel2).norm(), 1e-6);
  }
}

TEST(Render, RoadPixelsLieWhereTheTruthSays) {
  // Texture seen in one frame is where the homography of the truth says in the next: rendered light agrees.
  CameraPreset preset = small_camera();
  preset.options.world.asphalt.grain = 0.0;  // stains alone are smooth enough to be compared between pixels
  const SimulatedDrive drive = drive_along(plain_route({{100.0, 0.0}}, 4.0), preset, 3);
  const Renderer renderer(drive.world, preset.camera, {});
  const Radiance first = renderer.render(drive.moments[4].shutter);
  const Radiance second = renderer.render(drive.moments[5].shutter);
  const Eigen::Matrix3d homography = homography_of_plane(
      road_truth(drive, 4).plane, drive.moments[5].world_from_cam.inverse() * drive.moments[4].world_from_cam);
  const auto value = [](const Radiance& image, double x, double y) {
    const auto column = static_cast<std::size_t>(std::lround(x));
    const auto row = static_cast<std::size_t>(std::lround(y));
    return image.values[row * static_cast<std::size_t>(image.width) + column];
  };
  double squares_moved = 0.0;
  double squares_unmoved = 0.0;
  for (int y = 120; y < 160; y += 3) {
    for (int x = 200; x < 280; x += 3) {
      const auto mapped = preset.camera->project(homography * *preset.camera->ray({x, y}));
      if (!mapped || mapped->y() > 198.0) continue;
      squares_moved += std::pow(value(first, x, y) - value(second, mapped->x(), mapped->y()), 2);
      squares_unmoved += std::pow(value(first, x, y) - value(second, x, y), 2);
    }
  }
  EXPECT_LT(squares_moved, 0.25 * squares_unmoved);
}

TEST(RoadTruth, HasNoPlaneWhereTheRegionShowsNoRoad) {
  CameraPreset camera = small_camera();
  camera.region_px = {0.0, 100.0, 479.0, 100.0, 479.0, 199.0, 0.0, 199.0};
  SimulatedDrive drive = drive_along(plain_route({{100.0, 0.0}}, 10.0), camera, 3);
  EXPECT_TRUE(road_truth(drive, 0).has_plane);
  drive.camera.region_px = {0.0, 0.0, 479.0, 0.0, 479.0, 20.0, 0.0, 20.0};  // sky
  EXPECT_FALSE(road_truth(drive, 0).has_plane);
  EXPECT_GT(road_truth(drive, 0).height_m, 1.6);
}

TEST(Render, IsTheSameWithAnyNumberOfThreads) {
  const CameraPreset preset = find_camera_preset("small").value();
  const SimulatedDrive drive = drive_along(find_route("city").value(), preset, 1);
  const Shutter& shutter = drive.moments[1].shutter;
  const Radiance one = Renderer(drive.world, preset.camera, {.edge_rays = 8, .threads = 1}).render(shutter);
  EXPECT_EQ(Renderer(drive.world, preset.camera, {.edge_rays = 8, .threads = 3}).render(shutter).values, one.values);
}

TEST(Render, DepthAndRoadMaskAgreeWithTheTruth) {
  const CameraPreset preset = small_camera();
  const SimulatedDrive drive = drive_along(plain_route({{100.0, 0.0}}, 4.0), preset, 3);
  const Renderer renderer(drive.world, preset.camera, {});
  const RigidTransform& pose = drive.moments[3].world_from_cam;
  const std::vector<float> depth = renderer.depth(pose);
  const Image mask = renderer.road_mask(pose);
  const GroundPlane plane = road_truth(drive, 3).plane;
  for (const int y : {100, 130, 170}) {
    const Eigen::Vector3d ray = *preset.camera->ray({239.0, static_cast<double>(y)});
    const double expected = ray.z() * plane.height / plane.normal_in_cam.dot(ray);
    EXPECT_NEAR(depth[static_cast<std::size_t>(y * 480 + 239)], expected, 1e-3 * expected);
    EXPECT_EQ(mask.at(239, y), 255);
  }
  EXPECT_EQ(depth[239], 0.0F);  // sky
  EXPECT_EQ(mask.at(239, 0), 0);
  EXPECT_EQ(mask.at(2, 130), 0);  // the verge on the left
}

}  // namespace
}  // namespace groundscale
