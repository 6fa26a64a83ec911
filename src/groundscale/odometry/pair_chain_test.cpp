#include "groundscale/odometry/pair_chain.hpp"

#include <utility>

#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"

namespace groundscale {
namespace {

constexpr double kHeightM = 1.65;
constexpr double kStepM = 0.8;

/// A vehicle that drives straight on along the camera's axis, ten frames a second.
class PairChains : public testing::Test {
 protected:
  PairChains() : chain_(setup(), {}) { chain_.begin(next()); }

  static CameraSetup setup() {
    CameraSetup setup;
    setup.camera = PinholeCamera::create({.fx = 700.0, .fy = 700.0, .cx = 600.0, .cy = 180.0}, 1200, 370).value();
    setup.height_m = kHeightM;
    setup.pitch_rad = setup.roll_rad = 0.0;
    return setup;
  }
  FrameResult next() {
    FrameResult result;
    result.frame = frame_;
    result.time_s = 0.1 * frame_++;
    return result;
  }
  /// The next frame and one `back` before it, between which the road says `distance_m`; 0: it says nothing.
  const FrameResult& move(int back, double distance_m, const Mounting& seen = {}) {
    PairMotion pair;
    pair.partner = frame_ - back;
    pair.motion.state = MotionState::kMoving;
    pair.motion.cam2_from_cam1.translation = {0.0, 0.0, -1.0};
    return chain_.move(next(), pair, [&](double, FrameResult&) -> Result<RoadMeasurement> {
      if (distance_m <= 0.0) return Error{ErrorCode::kTooFewMatches, "no road"};
      RoadMeasurement measured;
      measured.plane.plane = measured.plane.initial_plane = {seen.normal_in_cam(), kHeightM / distance_m};
      // As points from 5 to 20 m say it: pitch and height err together.
      measured.plane.covariance_of_m << 1e-8, 0.0, 0.0, 0.0, 4e-7, -6e-7, 0.0, -6e-7, 1e-6;
      measured.plane.covariance_of_m *= distance_m * distance_m;
      for (const double x : {-1.0, 1.0}) {
        for (const double z : {5.0, 10.0, 20.0}) measured.inlier_rays.push_back({x / z, kHeightM / z, 1.0});
      }
      return measured;
    });
  }
  double pitch_deg() const {
    const Eigen::Vector3d normal = chain_.latest_warp(frame_ - 1)->road_in_cam1.normal_in_cam;
    return plane_angles(normal).pitch_rad * 57.295779513082;
  }

  int frame_ = 0;
  PairChain chain_;
};

TEST_F(PairChains, StepsAreWhatTheRoadSays) {
  for (int k = 0; k < 20; ++k) {
    const FrameResult& result = move(1, kStepM);
    EXPECT_TRUE(result.accepted()) << result.reason;
  }
  chain_.finish();
  EXPECT_NEAR(chain_.online_poses().back().translation.z(), 20 * kStepM, 0.01 * kStepM);
  EXPECT_NEAR(chain_.final_poses().back().translation.z(), 20 * kStepM, 0.01 * kStepM);
  EXPECT_NEAR(pitch_deg(), 0.0, 0.01);
}

TEST_F(PairChains, APairThatIsShorterThanWhatLiesBeforeItSaysThatThisWasTooMuch) {
  for (int k = 0; k < 20; ++k) move(1, kStepM);
  // It has braked unseen, while the chain went on at the speed it knew.
  for (int k = 0; k < 10; ++k) EXPECT_FALSE(move(1, 0.0).accepted());
  const FrameResult& seen = move(11, 3.0);
  ASSERT_TRUE(seen.accepted()) << seen.reason;
  EXPECT_NEAR(seen.online_step_m, 3.0 / 11.0, 0.1 * kStepM);
  EXPECT_NEAR(pitch_deg(), 0.0, 0.5);
}

TEST_F(PairChains, AFirstScaleFromALongPairIsThatOfItsShortSteps) {
  constexpr int kFramesBefore = 29;
  for (int k = 0; k < kFramesBefore; ++k) EXPECT_FALSE(move(1, 0.0).accepted());
  // 30 steps in 24 m: the last one isn't what the others leave over.
  const FrameResult& seen = move(kFramesBefore + 1, 30 * kStepM);
  ASSERT_TRUE(seen.accepted()) << seen.reason;
  EXPECT_NEAR(seen.online_step_m, kStepM, 0.05 * kStepM);
}

TEST_F(PairChains, WhereTheRoadIsSearchedForItIsExpectedAsOnAverage) {
  for (int k = 0; k < 20; ++k) move(1, kStepM);
  EXPECT_TRUE(move(1, kStepM, {.pitch_rad = 0.03}).accepted());
  EXPECT_GT(pitch_deg(), 0.3);
  EXPECT_FALSE(chain_.needs_search());
  for (int k = 0; k < GroundOptions{}.search_after; ++k) move(1, 0.0);
  ASSERT_TRUE(chain_.needs_search());
  const RoadWarp expected = chain_.expected_warp({Eigen::Matrix3d::Identity(), -Eigen::Vector3d::UnitZ()}, kStepM);
  EXPECT_LT((expected.road_in_cam1.normal_in_cam - chain_.mounting().mean_normal()).norm(), 1e-12);
  EXPECT_NEAR(plane_angles(chain_.mounting().mean_normal()).pitch_rad, 0.0, 0.003);
  EXPECT_DOUBLE_EQ(expected.cam2_from_cam1.translation.norm(), kStepM);
}

}  // namespace
}  // namespace groundscale
