#include "groundscale/odometry/method_comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/road/ground_methods.hpp"
#include "synthetic_drive.hpp"

namespace groundscale {
namespace {

constexpr int kFrames = 10;
constexpr std::size_t kUnreadable = 6;
constexpr double kHeightInBaselines = 2.5;

/// Always the same plane, with all road points on it.
Result<PlaneMeasurement> same_plane(const RoadObservations& observations, const PlaneOptions&, Rng&) {
  PlaneMeasurement measurement;
  measurement.plane = measurement.initial_plane = {Eigen::Vector3d::UnitY(), kHeightInBaselines};
  measurement.covariance_of_m = 1e-8 * Eigen::Matrix3d::Identity();
  for (std::size_t i = 0; i < observations.points.size(); ++i) measurement.inliers.push_back(static_cast<int>(i));
  return measurement;
}

Result<PlaneMeasurement> no_plane(const RoadObservations&, const PlaneOptions&, Rng&) {
  return Error{ErrorCode::kNotGround, "there is none"};
}

/// Passes on what sparse says, and draws random numbers as it likes.
Result<PlaneMeasurement> restless_sparse(const RoadObservations& observations, const PlaneOptions& options, Rng& rng) {
  Rng same(7);
  rng.next();
  return estimate_plane_sparse(observations, options, same);
}

const MethodComparison& compared() {
  static const MethodComparison comparison = [] {
    const SyntheticDrive drive;
    CameraSetup setup;
    setup.camera = *PinholeCamera::create(
        {.fx = drive.focal_px, .fy = drive.focal_px, .cx = drive.cx(), .cy = drive.cy()}, drive.width, drive.height);
    setup.height_m = drive.camera_height_m;
    const std::vector<PlaneMethod> methods = {{"sparse", "", make_memoryless<estimate_plane_sparse>},
                                              {"same", "", make_memoryless<same_plane>},
                                              {"none", "", make_memoryless<no_plane>},
                                              {"first", "", make_memoryless<restless_sparse>},
                                              {"second", "", make_memoryless<restless_sparse>}};
    auto made = MethodComparison::create(setup, {}, methods);
    GS_CHECK(made.has_value(), "the street is in view");
    for (int k = 0; k < kFrames; ++k) {
      Frame frame;
      frame.index = k;
      frame.time_s = 0.1 * k;
      if (k != kUnreadable) frame.image = drive.render(drive.step_m * k);
      frame.problem = "unreadable";
      made->advance(frame, {});
    }
    made->finish();
    return std::move(*made);
  }();
  return comparison;
}

const ComparedMethod& method(std::string_view name) {
  for (const ComparedMethod& method : compared().methods()) {
    if (method.name() == name) return method;
  }
  GS_CHECK(false, "a method of the comparison");
  return compared().methods().front();
}

TEST(MethodComparison, EachFrameIsTheFrontsFrameInEveryChain) {
  for (const ComparedMethod& method : compared().methods()) {
    ASSERT_EQ(method.results().size(), static_cast<std::size_t>(kFrames));
    for (std::size_t k = 0; k < method.results().size(); ++k) {
      const FrameResult& own = method.results()[k];
      const FrameResult& seen = compared().front().results()[k];
      EXPECT_EQ(own.frame, seen.frame);
      EXPECT_EQ(own.state, seen.state) << method.name() << ' ' << k;
      EXPECT_EQ(own.matches, seen.matches);
      if (own.state != FrameState::kMoving) continue;
      EXPECT_EQ(own.reference, seen.reference);
      EXPECT_EQ(own.reference_from_cam, seen.reference_from_cam);
      EXPECT_EQ(own.direction_in_reference, seen.direction_in_reference);
      EXPECT_EQ(own.road_matches, seen.road_matches);
    }
    EXPECT_EQ(method.results()[kUnreadable].reason, "unreadable");
  }
}

TEST(MethodComparison, TheFrontsOwnMethodSaysWhatTheFrontSays) {
  const auto& own = method("sparse").results();
  for (std::size_t k = 1; k < own.size(); ++k) {
    // Other random samples of a road without outliers end in the same plane, to the refinement's last digits.
    EXPECT_NEAR(own[k].online_step_m, compared().front().results()[k].online_step_m, 2e-3) << k;
  }
}

TEST(MethodComparison, AStepIsTheCamerasHeightOverThatOfThePlane) {
  for (const FrameResult& result : method("same").results()) {
    if (result.state != FrameState::kMoving || result.reference + 1 != result.frame) continue;
    ASSERT_TRUE(result.raw_over_online) << result.reason;
    EXPECT_NEAR(*result.raw_over_online * result.online_step_m, SyntheticDrive{}.camera_height_m / kHeightInBaselines,
                1e-9);
  }
}

TEST(MethodComparison, AMethodThatNeverMeasuresSaysWhyAndHasNoScale) {
  const ComparedMethod& none = method("none");
  EXPECT_FALSE(none.scaled());
  for (const FrameResult& result : none.results()) {
    EXPECT_FALSE(result.accepted());
    if (result.state == FrameState::kMoving) {
      EXPECT_EQ(result.reason, "there is none");
    }
  }
}

TEST(MethodComparison, MethodsDoNotDisturbEachOther) {
  const auto& first = method("first").results();
  const auto& second = method("second").results();
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_EQ(first[k].online_step_m, second[k].online_step_m);
    EXPECT_EQ(first[k].step_m, second[k].step_m);
    EXPECT_EQ(first[k].raw_over_online, second[k].raw_over_online);
  }
}

TEST(MethodsCsv, HasARowAFrameAndMethod) {
  const std::string csv = methods_csv(compared().methods());
  EXPECT_THAT(csv, testing::StartsWith("frame,method,raw_step_m,raw_step_sd_m,online_step_m,pitch_deg,roll_deg,"
                                       "inliers,time_ms,reason\n0,sparse,,,,,,0,,first frame\n0,same,"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + kFrames * 5);
  EXPECT_THAT(csv, testing::HasSubstr("there is none\n"));
}

TEST(ChooseMethods, FindsThemByNameInTheirOrder) {
  const auto chosen = choose_methods({"sparse"});
  ASSERT_TRUE(chosen);
  EXPECT_EQ(chosen->front().name, "sparse");
}

TEST(ChooseMethods, NamesThoseThatAreThereWhereOneIsNot) {
  const auto chosen = choose_methods({"sparse", "spares"});
  ASSERT_FALSE(chosen);
  EXPECT_EQ(chosen.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(chosen.error().message, testing::HasSubstr("\"spares\" is no method, known: sparse"));
  EXPECT_FALSE(choose_methods({"sparse", "sparse"}));
  EXPECT_FALSE(choose_methods({}));
}

}  // namespace
}  // namespace groundscale
