#include "groundscale/road/road_detector.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "groundscale/camera/kannala_brandt.hpp"
#include "groundscale/camera/pinhole.hpp"
#include "groundscale/road/test_network_internal.hpp"

namespace groundscale {
namespace {

constexpr int kWidth = 480;
constexpr int kHeight = 240;
const GroundPlane kRoad{Eigen::Vector3d(0.01, 1.0, 0.02).normalized(), 1.65};
const RoadWarp kForwards{{Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY()).toRotationMatrix(), {0.02, 0.01, -0.8}},
                         kRoad};

CameraPtr pinhole() {
  return *PinholeCamera::create({.fx = 400.0, .fy = 400.0, .cx = 240.0, .cy = 60.0, .k1 = -0.05}, kWidth, kHeight);
}
CameraPtr fisheye() {
  return *KannalaBrandtCamera::create({.fx = 160.0, .fy = 160.0, .cx = 240.0, .cy = 90.0, .k1 = 0.02}, kWidth, kHeight);
}

Image filled(int grey) {
  Image image(kWidth, kHeight);
  std::fill_n(image.data(), kWidth * kHeight, static_cast<std::uint8_t>(grey));
  return image;
}

/// A bent road as a camera sees it, by intersecting each pixel's ray with the plane: between 4 and 20 m of camera 1,
/// and up to 1.6 m from an arc.
Image bent_road(const Camera& camera, const GroundPlane& road, const RigidTransform& cam1_from_cam) {
  Image mask(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto ray = camera.ray({x, y});
      const double slope = ray ? road.normal_in_cam.dot(*ray) : 0.0;
      bool inside = false;
      if (slope > 0.0) {
        const Eigen::Vector3d point = cam1_from_cam * Eigen::Vector3d(*ray * (road.height / slope));
        inside = point.z() > 4.0 && point.z() < 20.0 && std::abs(point.x() - 0.01 * point.z() * point.z()) < 1.6;
      }
      mask.data()[y * kWidth + x] = inside ? 255 : 0;
    }
  }
  return mask;
}

int differing(const Image& a, const Image& b) {
  int count = 0;
  for (int i = 0; i < kWidth * kHeight; ++i) count += a.data()[i] != b.data()[i] ? 1 : 0;
  return count;
}

/// The same where `unseen` is 0, which is how a mask of zeros comes out where something was seen.
int differing(const Image& a, const Image& b, const Image& unseen) {
  int count = 0;
  for (int i = 0; i < kWidth * kHeight; ++i) count += unseen.data()[i] == 0 && a.data()[i] != b.data()[i] ? 1 : 0;
  return count;
}

int area(const Image& mask) { return static_cast<int>(std::count(mask.data(), mask.data() + kWidth * kHeight, 255)); }

/// Pixels of 255 beside a pixel of 0.
int edge_length(const Image& mask) {
  int count = 0;
  for (int y = 1; y + 1 < kHeight; ++y) {
    for (int x = 1; x + 1 < kWidth; ++x) {
      const bool all =
          mask.at(x - 1, y) != 0 && mask.at(x + 1, y) != 0 && mask.at(x, y - 1) != 0 && mask.at(x, y + 1) != 0;
      if (mask.at(x, y) != 0 && !all) ++count;
    }
  }
  return count;
}

TEST(CarryMask, IsWhereTheRoadIsSeenNext) {
  for (const CameraPtr& camera : {pinhole(), fisheye()}) {
    const Image before = bent_road(*camera, kRoad, {});
    const Image expected =
        bent_road(*camera, kRoad.seen_from(kForwards.cam2_from_cam1), kForwards.cam2_from_cam1.inverse());
    const Image carried = carry_mask(before, kForwards, *camera);
    const Image unseen = carry_mask(filled(0), kForwards, *camera);
    ASSERT_GT(area(expected), 3000) << camera->model();
    EXPECT_LT(area(unseen), kWidth * kHeight / 50) << camera->model();
    EXPECT_GT(differing(before, expected, unseen), 2 * edge_length(expected)) << camera->model() << ": nothing moves";
    // Half a pixel along the edge: right to the rounding of masks to pixels.
    EXPECT_LT(differing(carried, expected, unseen), edge_length(expected) / 2) << camera->model();
  }
}

TEST(CarryMask, WithoutMotionIsTheSame) {
  for (const CameraPtr& camera : {pinhole(), fisheye()}) {
    const Image mask = bent_road(*camera, kRoad, {});
    EXPECT_EQ(differing(carry_mask(mask, {{}, kRoad}, *camera), mask), 0) << camera->model();
  }
}

TEST(CarryMask, ForthAndBackIsTheSameButForItsEdge) {
  const CameraPtr camera = pinhole();
  const Image mask = bent_road(*camera, kRoad, {});
  const RigidTransform& there = kForwards.cam2_from_cam1;
  const RoadWarp home{there.inverse(), kRoad.seen_from(there)};
  const auto forth_and_back = [&](const Image& image) {
    return carry_mask(carry_mask(image, kForwards, *camera), home, *camera);
  };
  const Image unseen = forth_and_back(filled(0));
  EXPECT_LT(area(unseen), kWidth * kHeight / 3);
  EXPECT_LT(differing(forth_and_back(mask), mask, unseen), edge_length(mask) / 2);
}

TEST(CarryMask, AllowsWhatWasNotSeen) {
  const CameraPtr camera = pinhole();
  // Reversing brings road into view at the lower edge, a turn at one side.
  const Image reversed = carry_mask(filled(0), {{Eigen::Matrix3d::Identity(), {0.0, 0.0, 0.8}}, kRoad}, *camera);
  EXPECT_EQ(reversed.at(240, kHeight - 1), 255);
  EXPECT_EQ(reversed.at(240, 150), 0);
  const Eigen::Matrix3d left = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Image turned = carry_mask(filled(0), {{left, Eigen::Vector3d::Zero()}, kRoad}, *camera);
  EXPECT_EQ(turned.at(5, 120), 255);
  EXPECT_EQ(turned.at(60, 120), 0);
  EXPECT_EQ(turned.at(kWidth - 1, 120), 0);
}

TEST(CarryMask, AboveTheHorizonOnlyRotationCounts) {
  const CameraPtr camera = pinhole();
  Image mask = filled(0);
  for (int y = 10; y < 30; ++y) std::fill_n(mask.data() + y * kWidth + 100, 80, std::uint8_t{255});
  EXPECT_EQ(differing(carry_mask(mask, {{Eigen::Matrix3d::Identity(), {0.0, 0.0, -1.0}}, kRoad}, *camera), mask), 0);
}

class RoadDetectorOfDark : public testing::Test {
 protected:
  /// Road is what is dark.
  RoadDetector detector(int every) const {
    return std::move(*RoadDetector::open({.file = file_.path(), .erode_px = 0, .every = every}, camera));
  }
  CameraPtr camera = pinhole();
  Image road = bent_road(*camera, kRoad, {});
  Image none = filled(0);

  /// The image in which the network sees this road.
  static Image image_of(const Image& mask) {
    Image image(kWidth, kHeight);
    std::transform(mask.data(), mask.data() + kWidth * kHeight, image.data(),
                   [](std::uint8_t value) { return static_cast<std::uint8_t>(value == 0 ? 220 : 30); });
    return image;
  }

 private:
  TestFile file_{TestNetwork::dark_is_road(kWidth, kHeight)};
};

TEST_F(RoadDetectorOfDark, RunsEveryThirdFrameAndCarriesInBetween) {
  RoadDetector every_third = detector(3);
  const Image first = every_third.advance(image_of(road), std::nullopt);
  EXPECT_EQ(differing(first, road), 0);
  // Two frames in which the network would see nothing.
  const Image second = every_third.advance(image_of(none), kForwards);
  EXPECT_EQ(differing(second, carry_mask(road, kForwards, *camera)), 0);
  const Image third = every_third.advance(image_of(none), kForwards);
  EXPECT_EQ(differing(third, carry_mask(second, kForwards, *camera)), 0);
  EXPECT_EQ(every_third.runs(), 1);
  EXPECT_EQ(area(every_third.advance(image_of(none), kForwards)), 0);
  EXPECT_EQ(every_third.runs(), 2);
  EXPECT_GT(every_third.network_s(), 0.0);
}

TEST_F(RoadDetectorOfDark, RunsForEveryFrameWhereAskedTo) {
  RoadDetector every = detector(1);
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(differing(every.advance(image_of(k % 2 == 0 ? road : none), kForwards), k % 2 == 0 ? road : none), 0);
  }
  EXPECT_EQ(every.runs(), 4);
}

TEST_F(RoadDetectorOfDark, RunsWhereTheMotionIsUnknownAndCountsFromThere) {
  RoadDetector every_third = detector(3);
  (void)every_third.advance(image_of(none), kForwards);  // the first frame: nothing to carry
  (void)every_third.advance(image_of(none), kForwards);
  EXPECT_EQ(differing(every_third.advance(image_of(road), std::nullopt), road), 0);
  EXPECT_EQ(every_third.runs(), 2);
  (void)every_third.advance(image_of(none), kForwards);
  (void)every_third.advance(image_of(none), kForwards);
  EXPECT_EQ(every_third.runs(), 2);
  (void)every_third.advance(image_of(none), kForwards);
  EXPECT_EQ(every_third.runs(), 3);
}

TEST(RoadDetector, HandsOnWhyTheNetworkCantBeUsed) {
  const auto detector = RoadDetector::open({.file = "nowhere/road.onnx"}, pinhole());
  ASSERT_FALSE(detector);
  EXPECT_EQ(detector.error().code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace groundscale
