#include "groundscale/mapping/bundle_adjustment.hpp"

#include <cmath>
#include <cstring>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/mapping/reprojection_internal.hpp"
#include "groundscale/mapping/test_street_internal.hpp"

namespace groundscale {
namespace {

using testing::HasSubstr;

const BundleOptions kToTheEnd{.max_iterations = 100, .min_relative_decrease = 0.0};

Eigen::Vector3d centre_of(const RigidTransform& cam_from_world) { return cam_from_world.inverse().translation; }

/// Root mean square over the free views.
double centre_error_m(const Bundle& bundle, const Bundle& truth) {
  double squares = 0.0;
  int count = 0;
  for (std::size_t v = 0; v < bundle.views.size(); ++v) {
    if (bundle.views[v].fixed) continue;
    squares += (centre_of(bundle.views[v].cam_from_world) - centre_of(truth.views[v].cam_from_world)).squaredNorm();
    ++count;
  }
  return std::sqrt(squares / count);
}

double rotation_error_rad(const Bundle& bundle, const Bundle& truth) {
  double worst = 0.0;
  for (std::size_t v = 0; v < bundle.views.size(); ++v) {
    worst = std::max(worst, rotation_angle(bundle.views[v].cam_from_world.rotation *
                                           truth.views[v].cam_from_world.rotation.transpose()));
  }
  return worst;
}

double huber_cost(const Bundle& bundle, double loss_px) {
  const HuberLoss loss{loss_px};
  double cost = 0.0;
  for (const BundleObservation& o : bundle.observations) {
    const RigidTransform& pose = bundle.views[static_cast<std::size_t>(o.view)].cam_from_world;
    const Eigen::Vector3d& point = bundle.points_in_world[static_cast<std::size_t>(o.point)];
    cost += loss.rho((bundle.camera->project(pose * point).value() - o.pixel).norm());
  }
  return cost;
}

bool same_bytes(const Bundle& a, const Bundle& b) {
  bool same = a.views.size() == b.views.size() && a.points_in_world.size() == b.points_in_world.size();
  for (std::size_t v = 0; same && v < a.views.size(); ++v) {
    const RigidTransform& first = a.views[v].cam_from_world;
    const RigidTransform& second = b.views[v].cam_from_world;
    same = std::memcmp(first.rotation.data(), second.rotation.data(), 9 * sizeof(double)) == 0 &&
           std::memcmp(first.translation.data(), second.translation.data(), 3 * sizeof(double)) == 0;
  }
  for (std::size_t p = 0; same && p < a.points_in_world.size(); ++p) {
    same = std::memcmp(a.points_in_world[p].data(), b.points_in_world[p].data(), 3 * sizeof(double)) == 0;
  }
  return same;
}

class OfEveryCamera : public testing::TestWithParam<TestCamera> {};

TEST_P(OfEveryCamera, DerivativesAreThoseOfFiniteDifferences) {
  const CameraPtr camera = test_camera(GetParam());
  Rng rng(1);
  for (int k = 0; k < 20; ++k) {
    const RigidTransform pose{exp_so3(0.1 * normal3(rng)), 0.3 * normal3(rng)};
    const Eigen::Vector3d point = pose.inverse() * street_point(*camera, rng);
    const auto seen = reproject(*camera, pose, point);
    ASSERT_TRUE(seen);
    constexpr double kStep = 1e-6;
    const auto pixel_at = [&](const Eigen::Matrix<double, 6, 1>& d, const Eigen::Vector3d& shift) {
      return *camera->project(exp_so3(d.head<3>()) * pose.rotation * (point + shift) + pose.translation + d.tail<3>());
    };
    // Central differences: rounding 1e-10 of 1e3 px / 1e-6, so a relative 1e-6 of derivatives of up to 1e3.
    constexpr double kTolerance = 1e-3;
    for (int i = 0; i < 6; ++i) {
      const Eigen::Matrix<double, 6, 1> d = kStep * Eigen::Matrix<double, 6, 1>::Unit(i);
      const Eigen::Vector2d by = (pixel_at(d, {0, 0, 0}) - pixel_at(-d, {0, 0, 0})) / (2.0 * kStep);
      EXPECT_LT((by - seen->by_pose.col(i)).norm(), kTolerance) << "pose " << i;
    }
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d shift = kStep * Eigen::Vector3d::Unit(i);
      const Eigen::Matrix<double, 6, 1> none = Eigen::Matrix<double, 6, 1>::Zero();
      const Eigen::Vector2d by = (pixel_at(none, shift) - pixel_at(none, -shift)) / (2.0 * kStep);
      EXPECT_LT((by - seen->by_point.col(i)).norm(), kTolerance) << "point " << i;
    }
  }
}

TEST_P(OfEveryCamera, IsExactWithoutNoise) {
  Rng rng(2);
  const Bundle truth = street(test_camera(GetParam()), {}, rng);
  Bundle bundle = truth;
  disturb(bundle, 0.005, 0.05, 0.05, rng);
  const auto summary = adjust_bundle(bundle, kToTheEnd);
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_EQ(summary->observations, static_cast<int>(truth.observations.size()));
  EXPECT_GT(summary->initial_rms_px, 3.0);
  // The solver's relative tolerances end it near 1e-8 of the lengths.
  EXPECT_LT(summary->final_rms_px, 1e-5);
  EXPECT_LT(centre_error_m(bundle, truth), 1e-6);
  EXPECT_LT(rotation_error_rad(bundle, truth), 1e-7);
  for (std::size_t p = 0; p < truth.points_in_world.size(); ++p) {
    EXPECT_LT((bundle.points_in_world[p] - truth.points_in_world[p]).norm(), 1e-4);
  }
}

TEST_P(OfEveryCamera, NoSmallStepLowersTheCostOfTheResult) {
  Rng rng(3);
  Bundle bundle = street(test_camera(GetParam()), {.views = 6, .fixed = 2, .points = 60, .noise_px = 0.8}, rng);
  ASSERT_TRUE(adjust_bundle(bundle, kToTheEnd));
  const double cost = huber_cost(bundle, kToTheEnd.loss_px);
  // A step of 1e-4 rad or of 1e-4 of the distance is some 0.1 px: it must cost something.
  for (const double step : {1e-4, -1e-4}) {
    for (std::size_t v = 2; v < bundle.views.size(); ++v) {
      for (int i = 0; i < 3; ++i) {
        Bundle turned = bundle;
        turned.views[v].cam_from_world.rotation =
            exp_so3(step * Eigen::Vector3d::Unit(i)) * bundle.views[v].cam_from_world.rotation;
        EXPECT_GT(huber_cost(turned, kToTheEnd.loss_px), cost);
        Bundle shifted = bundle;
        shifted.views[v].cam_from_world.translation += 10.0 * step * Eigen::Vector3d::Unit(i);
        EXPECT_GT(huber_cost(shifted, kToTheEnd.loss_px), cost);
      }
    }
    for (std::size_t p = 0; p < bundle.points_in_world.size(); ++p) {
      for (int i = 0; i < 3; ++i) {
        Bundle shifted = bundle;
        shifted.points_in_world[p] += step * bundle.points_in_world[p].norm() * Eigen::Vector3d::Unit(i);
        EXPECT_GT(huber_cost(shifted, kToTheEnd.loss_px), cost);
      }
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Bundle, OfEveryCamera,
                         testing::Values(TestCamera::kPinhole, TestCamera::kDistorted, TestCamera::kFisheye));

TEST(LeftJacobian, IsThatOfFiniteDifferences) {
  for (const double angle : {0.0, 1e-5, 9e-4, 1.1e-3, 0.3, 2.0}) {
    const Eigen::Vector3d w = angle * Eigen::Vector3d(0.6, -0.64, 0.48);
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(i);
      const Eigen::Vector3d turn = log_so3(exp_so3(w + d) * exp_so3(w - d).transpose()) / (2.0 * kStep);
      EXPECT_LT((turn - left_jacobian(w).col(i)).norm(), 1e-9) << angle;
    }
  }
}

class BundleNoise : public testing::TestWithParam<double> {};

TEST_P(BundleNoise, ErrorGrowsWithItAndTheResidualIsWhatItLeaves) {
  Rng rng(4);
  const double noise_px = GetParam();
  const TestStreet size{.points = 400, .noise_px = noise_px};
  const Bundle truth = street(test_camera(TestCamera::kPinhole), size, rng);
  Bundle bundle = truth;
  disturb(bundle, 0.003, 0.03, 0.03, rng);
  const auto summary = adjust_bundle(bundle, {.max_iterations = 20});
  ASSERT_TRUE(summary);
  // 2 n residuals less 6 a free view and 3 a point; the rms of n such estimates scatters by less than 3 %.
  const double n = summary->observations;
  const double expected_px = noise_px * std::sqrt(2.0) * std::sqrt(1.0 - (8.0 * 6.0 + 3.0 * size.points) / (2.0 * n));
  EXPECT_NEAR(summary->final_rms_px, expected_px, 0.06 * expected_px);
  // Stated bounds: 5 cm and 2.5 mrad a pixel of noise, over a street of 8 free metres.
  EXPECT_LT(centre_error_m(bundle, truth), 0.05 * noise_px);
  EXPECT_LT(rotation_error_rad(bundle, truth), 2.5e-3 * noise_px);
}
INSTANTIATE_TEST_SUITE_P(Pixels, BundleNoise, testing::Values(0.1, 0.3, 0.6));

TEST(Bundle, LargeRotationsConvergeAsFastAsSmallOnes) {
  Rng rng(16);
  Bundle bundle = street(test_camera(TestCamera::kPinhole), {.views = 6, .fixed = 3, .points = 80}, rng);
  disturb(bundle, 0.3, 0.01, 0.0, rng);
  // Quadratic convergence: with derivatives that hold for small rotations only, 1e-3 px are left.
  const auto summary = adjust_bundle(bundle, {.max_iterations = 14, .loss_px = 100.0, .min_relative_decrease = 1e-12});
  ASSERT_TRUE(summary);
  EXPECT_GT(summary->initial_rms_px, 50.0);
  EXPECT_LT(summary->final_rms_px, 1e-6);
}

TEST(Bundle, CauchyTakesATenthOfWrongObservations) {
  Rng rng(5);
  const Bundle truth = street(test_camera(TestCamera::kPinhole), {.points = 300, .noise_px = 0.3}, rng);
  Bundle bundle = truth;
  for (BundleObservation& o : bundle.observations) {
    if (rng.uniform() < 0.1) o.pixel += 30.0 * normal2(rng);
  }
  disturb(bundle, 0.002, 0.02, 0.02, rng);
  ASSERT_TRUE(adjust_bundle(bundle, {.max_iterations = 20, .loss = BundleLoss::kCauchy}));
  // Twice the bound without them.
  EXPECT_LT(centre_error_m(bundle, truth), 2.0 * 0.05 * 0.3);
}

TEST(Bundle, FixedViewsAndUnseenPointsStayAsTheyAre) {
  Rng rng(6);
  Bundle bundle = street(test_camera(TestCamera::kPinhole), {.noise_px = 0.3}, rng);
  disturb(bundle, 0.002, 0.02, 0.02, rng);
  const auto unseen = bundle.points_in_world.size();
  bundle.points_in_world.emplace_back(1.0, 2.0, 30.0);
  bundle.points_in_world.emplace_back(-1.0, 2.0, 30.0);  // seen once
  bundle.observations.push_back({3, static_cast<int>(unseen) + 1, {600.0, 200.0}});
  const Bundle before = bundle;
  const auto summary = adjust_bundle(bundle, {});
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->observations, static_cast<int>(bundle.observations.size()) - 1);
  for (std::size_t v = 0; v < bundle.views.size(); ++v) {
    const bool same = bundle.views[v].cam_from_world.rotation == before.views[v].cam_from_world.rotation &&
                      bundle.views[v].cam_from_world.translation == before.views[v].cam_from_world.translation;
    EXPECT_EQ(same, bundle.views[v].fixed) << v;
  }
  EXPECT_EQ(bundle.points_in_world[unseen], before.points_in_world[unseen]);
  EXPECT_EQ(bundle.points_in_world[unseen + 1], before.points_in_world[unseen + 1]);
}

TEST(Bundle, PointsAloneAreAdjustedWhereAllViewsAreFixed) {
  Rng rng(7);
  const Bundle truth = street(test_camera(TestCamera::kPinhole), {.fixed = 12}, rng);
  Bundle bundle = truth;
  disturb(bundle, 0.0, 0.0, 0.05, rng);
  const auto summary = adjust_bundle(bundle, kToTheEnd);
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_LT(summary->final_rms_px, 1e-5);
}

TEST(Bundle, WithOneFixedViewTheScaleStaysNearThatOfTheStart) {
  Rng rng(8);
  const Bundle truth = street(test_camera(TestCamera::kPinhole), {.fixed = 1, .noise_px = 0.3}, rng);
  Bundle bundle = truth;
  disturb(bundle, 0.002, 0.02, 0.01, rng);
  ASSERT_TRUE(adjust_bundle(bundle, {.max_iterations = 10}));
  std::vector<double> ratios;
  for (std::size_t p = 0; p < truth.points_in_world.size(); ++p) {
    ratios.push_back(bundle.points_in_world[p].norm() / truth.points_in_world[p].norm());
  }
  // The start's own scale: 2 cm of noise in 11 positions a metre apart.
  EXPECT_NEAR(median(ratios), 1.0, 0.02);
}

TEST(Bundle, AnObservationBehindItsCameraAtTheStartIsLeftOut) {
  Rng rng(9);
  const Bundle truth = street(test_camera(TestCamera::kPinhole), {}, rng);
  Bundle bundle = truth;
  // A view that has passed the point.
  bundle.points_in_world.emplace_back(0.5, 0.5, 5.0);
  const int point = static_cast<int>(bundle.points_in_world.size()) - 1;
  for (const int view : {0, 1, 2, 11}) {
    const auto& pose = bundle.views[static_cast<std::size_t>(view)].cam_from_world;
    const auto pixel = bundle.camera->project(pose * bundle.points_in_world.back());
    bundle.observations.push_back({view, point, pixel.value_or(Eigen::Vector2d(100.0, 100.0))});
  }
  disturb(bundle, 0.002, 0.02, 0.02, rng);
  const auto summary = adjust_bundle(bundle, kToTheEnd);
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->observations, static_cast<int>(bundle.observations.size()) - 1);
  EXPECT_LT(summary->final_rms_px, 1e-5);
  EXPECT_LT((bundle.points_in_world.back() - Eigen::Vector3d(0.5, 0.5, 5.0)).norm(), 1e-5);
}

TEST(Bundle, AStepThatSendsAPointBehindACameraIsShortenedForThatPointOnly) {
  Rng rng(10);
  const Bundle truth = street(test_camera(TestCamera::kPinhole), {}, rng);
  Bundle bundle = truth;
  disturb(bundle, 0.001, 0.01, 0.01, rng);
  // Depth is linear in the inverse of the parallax: from twenty times too far, Gauss-Newton jumps to
  // z - z^2 / z_true = -19 z.
  bundle.points_in_world[0] *= 20.0;
  const auto summary = adjust_bundle(bundle, kToTheEnd);
  ASSERT_TRUE(summary);
  EXPECT_GT(summary->shortened_steps, 0);
  EXPECT_LT(summary->final_rms_px, 1e-4);
  EXPECT_LT((bundle.points_in_world[0] - truth.points_in_world[0]).norm(), 1e-3);
}

/// Seen from starts that are far off: poses by degrees and a metre, points by half.
class BundleFromAfar : public testing::TestWithParam<TestCamera> {};

TEST_P(BundleFromAfar, NeverEndsWorseThanItBegan) {
  Rng rng(36);  // one for which the solver has something to complain about
  testing::internal::CaptureStderr();
  for (int trial = 0; trial < 40; ++trial) {
    Bundle bundle = street(test_camera(GetParam()), {.points = 60, .noise_px = 0.3}, rng);
    disturb(bundle, 0.05, 1.0, 0.5, rng);
    // What the adjustment leaves out.
    std::erase_if(bundle.observations, [&](const BundleObservation& o) {
      const RigidTransform& pose = bundle.views[static_cast<std::size_t>(o.view)].cam_from_world;
      return !bundle.camera->project(pose * bundle.points_in_world[static_cast<std::size_t>(o.point)]);
    });
    std::vector<int> seen(bundle.points_in_world.size(), 0);
    for (const BundleObservation& o : bundle.observations) ++seen[static_cast<std::size_t>(o.point)];
    std::erase_if(bundle.observations,
                  [&](const BundleObservation& o) { return seen[static_cast<std::size_t>(o.point)] < 2; });
    const double before = huber_cost(bundle, 1.0);
    const auto summary = adjust_bundle(bundle, {.max_iterations = 10});
    if (!summary) {
      ADD_FAILURE() << trial << ": " << summary.error().message;
      break;
    }
    EXPECT_EQ(summary->observations, static_cast<int>(bundle.observations.size()));
    // Every observation still projects, and the cost is lower.
    EXPECT_LT(huber_cost(bundle, 1.0), before) << trial;
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");  // some of the steps are refused; nobody asked to hear of it
}
INSTANTIATE_TEST_SUITE_P(Cameras, BundleFromAfar,
                         testing::Values(TestCamera::kPinhole, TestCamera::kDistorted, TestCamera::kFisheye));

TEST(Bundle, AViewWithOneObservationDoesNotUpsetTheOthers) {
  Rng rng(14);
  const Bundle truth = street(test_camera(TestCamera::kPinhole), {}, rng);
  Bundle bundle = truth;
  disturb(bundle, 0.002, 0.02, 0.02, rng);
  int left = 0;
  std::erase_if(bundle.observations, [&](const BundleObservation& o) { return o.view == 8 && ++left > 1; });
  const auto summary = adjust_bundle(bundle, kToTheEnd);
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_LT(summary->final_rms_px, 1e-4);
  EXPECT_LT((centre_of(bundle.views[9].cam_from_world) - centre_of(truth.views[9].cam_from_world)).norm(), 1e-4);
}

TEST(Bundle, TheSameInputGivesTheSameBytes) {
  Rng rng(11);
  Bundle first = street(test_camera(TestCamera::kDistorted), {.noise_px = 0.3}, rng);
  disturb(first, 0.002, 0.02, 0.02, rng);
  Bundle second = first;
  ASSERT_TRUE(adjust_bundle(first, {}));
  const auto other_addresses = std::make_unique<std::vector<double>>(12345);
  ASSERT_TRUE(adjust_bundle(second, {}));
  EXPECT_TRUE(same_bytes(first, second));
}

TEST(Bundle, TheOrderOfThePointsDoesNotMatter) {
  Rng rng(12);
  Bundle bundle = street(test_camera(TestCamera::kPinhole), {.noise_px = 0.3}, rng);
  disturb(bundle, 0.002, 0.02, 0.02, rng);
  Bundle reversed = bundle;
  std::reverse(reversed.observations.begin(), reversed.observations.end());
  ASSERT_TRUE(adjust_bundle(bundle, kToTheEnd));
  ASSERT_TRUE(adjust_bundle(reversed, kToTheEnd));
  EXPECT_LT(centre_error_m(bundle, reversed), 1e-6);
}

TEST(Bundle, WithoutSharedPointsThereIsNothingToAdjust) {
  Bundle bundle;
  bundle.camera = test_camera(TestCamera::kPinhole);
  bundle.views.resize(2);
  bundle.points_in_world.emplace_back(0.0, 0.0, 10.0);
  bundle.observations.push_back({0, 0, {620.0, 188.0}});
  const Bundle before = bundle;
  const auto summary = adjust_bundle(bundle, {});
  ASSERT_FALSE(summary);
  EXPECT_EQ(summary.error().code, ErrorCode::kTooFewMatches);
  EXPECT_THAT(summary.error().message, HasSubstr("none of 1 points"));
  EXPECT_TRUE(same_bytes(bundle, before));
}

TEST(Bundle, DefaultsAreInTheirRanges) { EXPECT_TRUE(check_ranges(BundleOptions{})); }

}  // namespace
}  // namespace groundscale
