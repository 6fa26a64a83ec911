#include "groundscale/mapping/relocalise.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "groundscale/camera/kannala_brandt.hpp"
#include "groundscale/camera/pinhole.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/tracking/detect.hpp"
#include "groundscale/tracking/test_texture_internal.hpp"

namespace groundscale {
namespace {

CameraPtr pinhole() {
  return PinholeCamera::create({.fx = 300.0, .fy = 300.0, .cx = 239.5, .cy = 99.5}, 480, 200).value();
}

/// Two walls of random texture that stand at an angle, 14 m ahead in their middle.
Image seen_from(const RigidTransform& world_from_cam, const Camera& camera) {
  static const TestTexture texture(11, /*shortest=*/0.5);
  return texture.render(camera.width(), camera.height(), [&](int x, int y) {
    const auto ray = camera.ray({static_cast<double>(x), static_cast<double>(y)});
    if (!ray) return Eigen::Vector2d(0.0, 0.0);
    const Eigen::Vector3d direction = world_from_cam.rotation * *ray;
    const Eigen::Vector3d& from = world_from_cam.translation;
    // z = 14 + 0.4 |x|, of which the nearer side is met.
    double along = 1e9;
    for (const double side : {-0.4, 0.4}) {
      const double share = (14.0 + side * from.x() - from.z()) / (direction.z() - side * direction.x());
      const Eigen::Vector3d place = from + share * direction;
      if (share > 0.0 && place.x() * side >= 0.0) along = std::min(along, share);
    }
    const Eigen::Vector3d place = from + along * direction;
    return Eigen::Vector2d(place.x(), place.y() + 50.0);
  });
}

/// A view at the origin, with landmarks at its corners.
MapView view_at_origin(const Camera& camera) {
  MapView view{seen_from({}, camera), {}};
  TrackId id = 5;
  for (const Eigen::Vector2d& pixel : detect_corners(view.image, {}, {}, {})) {
    const Eigen::Vector3d ray = camera.ray(pixel).value();
    const double share = 14.0 / (ray.z() - 0.4 * std::abs(ray.x()));
    view.landmarks.push_back({id++, pixel, share * ray});
  }
  return view;
}

Image darkened(const Image& image) {
  Image result(image.width(), image.height());
  const auto count = static_cast<std::ptrdiff_t>(image.width()) * image.height();
  std::transform(image.data(), image.data() + count, result.data(),
                 [](std::uint8_t grey) { return static_cast<std::uint8_t>(0.4 * grey); });
  return result;
}

/// Within what 0.3 px of 20 points at 14 m say, with room.
void expect_pose(const Result<Relocalised>& found, const RigidTransform& cam_from_world) {
  ASSERT_TRUE(found.has_value()) << found.error().message;
  EXPECT_LT((found->pose.cam_from_world.translation - cam_from_world.translation).norm(), 0.05);
  EXPECT_LT(rotation_angle(found->pose.cam_from_world.rotation * cam_from_world.rotation.transpose()), 0.004);
}

TEST(Relocalise, FindsThePoseAfterAStepWithoutKnowingIt) {
  const CameraPtr camera = pinhole();
  const RigidTransform world_from_cam{exp_so3({0.01, -0.03, 0.0}), {0.4, -0.05, 1.5}};
  Rng rng(1);
  expect_pose(relocalise({view_at_origin(*camera)}, seen_from(world_from_cam, *camera), *camera, {}, {}, rng),
              world_from_cam.inverse());
}

TEST(Relocalise, FindsItWhereThingsHaveGrownByAHalf) {
  const CameraPtr camera = pinhole();
  const RigidTransform world_from_cam{exp_so3({0.0, 0.02, 0.0}), {0.2, 0.0, 4.7}};
  const RigidTransform guess{Eigen::Matrix3d::Identity(), {0.0, 0.0, -4.0}};
  Rng rng(1);
  expect_pose(relocalise({view_at_origin(*camera)}, seen_from(world_from_cam, *camera), *camera, guess, {}, rng),
              world_from_cam.inverse());
}

TEST(Relocalise, FindsItThroughAChangeOfExposure) {
  const CameraPtr camera = pinhole();
  const RigidTransform world_from_cam{Eigen::Matrix3d::Identity(), {0.1, 0.0, 1.0}};
  Rng rng(1);
  const auto found =
      relocalise({view_at_origin(*camera)}, darkened(seen_from(world_from_cam, *camera)), *camera, {}, {}, rng);
  expect_pose(found, world_from_cam.inverse());
}

TEST(Relocalise, FindsItWithAFisheye) {
  const CameraPtr camera =
      KannalaBrandtCamera::create({.fx = 200.0, .fy = 200.0, .cx = 239.5, .cy = 99.5, .k1 = -0.02}, 480, 200).value();
  const RigidTransform world_from_cam{exp_so3({0.0, 0.02, 0.01}), {0.3, 0.0, 1.5}};
  Rng rng(1);
  expect_pose(relocalise({view_at_origin(*camera)}, seen_from(world_from_cam, *camera), *camera, {}, {}, rng),
              world_from_cam.inverse());
}

TEST(Relocalise, LandmarksComeBackUnderTheirIdsWhereTheyAreSeen) {
  const CameraPtr camera = pinhole();
  const MapView view = view_at_origin(*camera);
  const RigidTransform world_from_cam{Eigen::Matrix3d::Identity(), {0.3, 0.0, 1.5}};
  Rng rng(1);
  const auto found = relocalise({view}, seen_from(world_from_cam, *camera), *camera, {}, {}, rng);
  ASSERT_TRUE(found.has_value());
  ASSERT_GE(found->sights.size(), 20U);
  TrackId before = 0;
  std::vector<double> errors;
  for (const TrackPoint& sight : found->sights) {
    EXPECT_GT(sight.id, before);
    before = sight.id;
    const auto& landmark = view.landmarks[static_cast<std::size_t>(sight.id - 5)];
    ASSERT_EQ(landmark.id, sight.id);
    const auto pixel = camera->project(world_from_cam.inverse() * landmark.point_in_world);
    ASSERT_TRUE(pixel.has_value());
    errors.push_back((*pixel - sight.pixel).norm());
  }
  std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.5);  // patches have grown by a twentieth more than the step of sizes
}

TEST(Relocalise, FindsNothingInAnotherPlaceOrInTheDark) {
  const CameraPtr camera = pinhole();
  const MapView view = view_at_origin(*camera);
  Rng rng(1);
  const RigidTransform elsewhere{Eigen::Matrix3d::Identity(), {90.0, 0.0, 0.0}};
  EXPECT_FALSE(relocalise({view}, seen_from(elsewhere, *camera), *camera, {}, {}, rng).has_value());
  EXPECT_FALSE(relocalise({view}, Image(480, 200), *camera, {}, {}, rng).has_value());
  EXPECT_FALSE(relocalise({}, view.image, *camera, {}, {}, rng).has_value());
}

TEST(Relocalise, IsTheSameForTheSameSeed) {
  const CameraPtr camera = pinhole();
  const Image image = seen_from({Eigen::Matrix3d::Identity(), {0.3, 0.0, 1.5}}, *camera);
  Rng a(3);
  Rng b(3);
  const auto first = relocalise({view_at_origin(*camera)}, image, *camera, {}, {}, a);
  const auto second = relocalise({view_at_origin(*camera)}, image, *camera, {}, {}, b);
  ASSERT_TRUE(first.has_value() && second.has_value());
  EXPECT_EQ(first->pose.cam_from_world.translation, second->pose.cam_from_world.translation);
}

}  // namespace
}  // namespace groundscale
