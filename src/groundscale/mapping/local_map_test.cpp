#include "groundscale/mapping/local_map.hpp"

#include <cmath>
#include <map>
#include <vector>

#include <gmock/gmock.h>

#include "groundscale/mapping/test_street_internal.hpp"

namespace groundscale {
namespace {

/// A camera that drives along a street; each point keeps its id for as long as it is in view.
class Drive {
 public:
  explicit Drive(double noise_px = 0.0, std::uint64_t seed = 1)
      : camera_(test_camera(TestCamera::kPinhole)), noise_px_(noise_px), rng_(seed) {
    constexpr int kPoints = 600;
    for (int i = 0; i < kPoints; ++i) {
      points_.emplace_back(rng_.uniform(-12.0, 12.0), rng_.uniform(-4.0, 1.5), rng_.uniform(4.0, 80.0));
    }
  }

  const CameraPtr& camera() const { return camera_; }
  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  /// True pose after so many steps of a metre, slowly turning.
  static RigidTransform cam_from_world(int k) {
    const RigidTransform world_from_cam{exp_so3(Eigen::Vector3d(0.0, 0.01 * k, 0.0)),
                                        Eigen::Vector3d(0.005 * k * k, 0.0, 1.0 * k)};
    return world_from_cam.inverse();
  }
  std::vector<TrackPoint> seen(int k) {
    std::vector<TrackPoint> tracks;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Vector3d in_cam = cam_from_world(k) * points_[i];
      const auto pixel = camera_->project(in_cam);
      constexpr double kNear = 3.0;
      constexpr double kFar = 30.0;
      if (!pixel || !camera_->contains(*pixel) || in_cam.z() < kNear || in_cam.z() > kFar) continue;
      tracks.push_back({static_cast<TrackId>(i), *pixel + noise_px_ * normal2(rng_)});
    }
    return tracks;
  }

 private:
  CameraPtr camera_;
  double noise_px_;
  Rng rng_;
  std::vector<Eigen::Vector3d> points_;
};

/// A map of the first `count` keyframes, each placed where the last two lead and then adjusted.
LocalMap driven(Drive& drive, int count, const LocalMapOptions& options = {}) {
  LocalMap map(drive.camera(), options);
  for (int k = 0; k < count; ++k) {
    RigidTransform guess = Drive::cam_from_world(k);
    if (k > 1) guess.translation += Eigen::Vector3d(0.02, -0.01, 0.03);
    map.add(k, guess, drive.seen(k));
    map.triangulate();
    map.adjust();
  }
  return map;
}

double centre_error(const LocalMap& map) {
  const Keyframe& last = map.keyframes().back();
  return (last.cam_from_world.inverse().translation - Drive::cam_from_world(last.frame).inverse().translation).norm();
}

TEST(LocalMap, FindsPosesAndPointsOfAStreet) {
  Drive drive;
  const LocalMap map = driven(drive, 12);
  // Two fixed keyframes at the true distance hold the scale; what is left is the start's, a window ago.
  EXPECT_LT(centre_error(map), 0.05);
  EXPECT_GT(map.point_count(), 100);
  int near = 0;
  int known = 0;
  for (std::size_t i = 0; i < drive.points().size(); ++i) {
    const Eigen::Vector3d* point = map.point_of(static_cast<TrackId>(i));
    if (point == nullptr) continue;
    ++known;
    if ((*point - drive.points()[i]).norm() < 0.5) ++near;
  }
  EXPECT_GT(near, 0.9 * known);
}

TEST(LocalMap, KeepsNoMoreThanItsKeyframes) {
  Drive drive;
  LocalMapOptions options;
  const LocalMap map = driven(drive, 20, options);
  EXPECT_EQ(static_cast<int>(map.keyframes().size()), options.free_keyframes + options.fixed_keyframes);
  EXPECT_EQ(map.find(0), nullptr);
  ASSERT_NE(map.find(19), nullptr);
  EXPECT_EQ(map.find(19)->frame, 19);
  EXPECT_EQ(map.find(20), nullptr);
}

TEST(LocalMap, FixedKeyframesDoNotMove) {
  Drive drive(0.3);
  LocalMapOptions options;
  LocalMap map = driven(drive, 12, options);
  const RigidTransform before = map.keyframes().front().cam_from_world;
  map.adjust();
  EXPECT_EQ(map.keyframes().front().cam_from_world.translation, before.translation);
  EXPECT_EQ(map.keyframes().front().cam_from_world.rotation, before.rotation);
}

TEST(LocalMap, APointThatMovesIsRejectedAndStaysSo) {
  Drive drive;
  LocalMap map = driven(drive, 6);
  const TrackId mover = map.keyframes().back().points.front().id;
  ASSERT_NE(map.point_of(mover), nullptr);
  const LocalMapOptions options;
  for (int strike = 0; strike < options.strikes; ++strike) map.judge({mover}, {false});
  EXPECT_EQ(map.point_of(mover), nullptr);
  map.add(6, Drive::cam_from_world(6), drive.seen(6));
  map.triangulate();
  EXPECT_EQ(map.point_of(mover), nullptr);
}

TEST(LocalMap, AgreementEndsARowOfStrikes) {
  Drive drive;
  LocalMap map = driven(drive, 6);
  const TrackId id = map.keyframes().back().points.front().id;
  const LocalMapOptions options;
  for (int round = 0; round < 3; ++round) {
    for (int strike = 0; strike + 1 < options.strikes; ++strike) map.judge({id}, {false});
    map.judge({id}, {true});
  }
  EXPECT_NE(map.point_of(id), nullptr);
}

TEST(LocalMap, NoLandmarkWithoutParallax) {
  Drive drive;
  LocalMap map(drive.camera(), {});
  map.add(0, Drive::cam_from_world(0), drive.seen(0));
  map.add(1, Drive::cam_from_world(0), drive.seen(0));
  EXPECT_EQ(map.triangulate(), 0);
  EXPECT_EQ(map.point_count(), 0);
}

TEST(LocalMap, ScalesTheLatestKeyframesAboutTheOldestOfThem) {
  Drive drive;
  LocalMap map = driven(drive, 12);
  const std::deque<Keyframe> before = map.keyframes();
  constexpr double kLambda = 1.1;
  const Keyframe& still = map.scale(kLambda);
  const LocalMapOptions options;
  EXPECT_EQ(still.serial, before.back().serial - options.free_keyframes + 1);
  const Eigen::Vector3d origin = still.cam_from_world.inverse().translation;
  for (std::size_t k = 0; k < before.size(); ++k) {
    const Eigen::Vector3d was = before[k].cam_from_world.inverse().translation;
    const Eigen::Vector3d is = map.keyframes()[k].cam_from_world.inverse().translation;
    EXPECT_EQ(map.keyframes()[k].cam_from_world.rotation, before[k].cam_from_world.rotation);
    const Eigen::Vector3d expected =
        before[k].serial < still.serial ? was : Eigen::Vector3d(origin + kLambda * (was - origin));
    EXPECT_LT((is - expected).norm(), 1e-12);
  }
}

double last_step(const LocalMap& map) {
  const auto& keyframes = map.keyframes();
  return (keyframes.back().cam_from_world.inverse().translation -
          keyframes[keyframes.size() - 2].cam_from_world.inverse().translation)
      .norm();
}

/// One keyframe more, where the last two lead.
void drive_on(LocalMap& map, Drive& drive, int k) {
  const auto& keyframes = map.keyframes();
  const RigidTransform motion =
      keyframes.back().cam_from_world * keyframes[keyframes.size() - 2].cam_from_world.inverse();
  map.add(k, motion * keyframes.back().cam_from_world, drive.seen(k));
  map.triangulate();
  map.adjust();
}

/// Old keyframes that see the same points would pull a correction back. Steps against those of the same map without it.
TEST(LocalMap, NinetyNinePercentOfACorrectionRemain) {
  for (const double lambda : {0.9, 1.1}) {
    Drive drive;
    LocalMap corrected = driven(drive, 12);
    LocalMap left_alone = driven(drive, 12);
    const Keyframe still = corrected.scale(lambda);
    corrected.adjust();
    EXPECT_NEAR(last_step(corrected) / last_step(left_alone), lambda, 0.01 * lambda);
    const LocalMapOptions options;
    for (int k = 12; k < 12 + 2 * options.free_keyframes; ++k) {
      drive_on(corrected, drive, k);
      drive_on(left_alone, drive, k);
      EXPECT_NEAR(last_step(corrected) / last_step(left_alone), lambda, 0.01 * lambda) << "keyframe " << k;
    }
    EXPECT_GT(corrected.keyframes().front().serial, still.serial);
  }
}

TEST(LocalMap, AGroundThatAsksForLongerStepsGetsThem) {
  Drive drive(0.2);
  LocalMap map(drive.camera(), {});
  constexpr double kLonger = 1.05;
  for (int k = 0; k < 20; ++k) {
    RigidTransform guess = Drive::cam_from_world(k);
    if (k > 1) {
      const auto& keyframes = map.keyframes();
      guess = keyframes.back().cam_from_world * keyframes[keyframes.size() - 2].cam_from_world.inverse() *
              keyframes.back().cam_from_world;
    }
    map.add(k, guess, drive.seen(k));
    map.triangulate();
    map.adjust();
    if (k > 0) map.set_distance(kLonger, 0.001);
  }
  const auto& keyframes = map.keyframes();
  const double step = (keyframes[keyframes.size() - 2].cam_from_world.inverse().translation -
                       keyframes[keyframes.size() - 3].cam_from_world.inverse().translation)
                          .norm();
  EXPECT_NEAR(step, kLonger, 0.01);
}

TEST(LocalMap, IsTheSameToTheLastBitWhenRunAgain) {
  Drive a(0.3);
  Drive b(0.3);
  const LocalMap first = driven(a, 15);
  const LocalMap second = driven(b, 15);
  for (std::size_t k = 0; k < first.keyframes().size(); ++k) {
    EXPECT_EQ(first.keyframes()[k].cam_from_world.translation, second.keyframes()[k].cam_from_world.translation);
  }
}

}  // namespace
}  // namespace groundscale
