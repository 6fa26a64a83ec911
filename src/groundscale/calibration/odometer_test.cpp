#include "groundscale/calibration/odometer.hpp"

#include <gtest/gtest.h>

namespace groundscale {
namespace {

TEST(Odometer, IsLinearBetweenFrames) {
  const Odometer odometer({0.0, 0.1, 0.3, 0.4}, {std::nullopt, 1.0, 4.0, 1.0});
  EXPECT_NEAR(odometer.distance_m(0.0, 0.4).value(), 6.0, 1e-12);
  EXPECT_NEAR(odometer.distance_m(0.05, 0.2).value(), 0.5 + 2.0, 1e-12);
  EXPECT_NEAR(odometer.distance_m(0.1, 0.3).value(), 4.0, 1e-12);
  EXPECT_FALSE(odometer.distance_m(-0.01, 0.2));
  EXPECT_FALSE(odometer.distance_m(0.1, 0.41));
  EXPECT_NEAR(odometer.length_m(), 6.0, 1e-12);
  EXPECT_NEAR(odometer.median_interval_s(), 0.1, 1e-12);
}

TEST(Odometer, KnowsNothingOfStretchesThatWereBridged) {
  const Odometer odometer({0.0, 0.1, 0.2, 0.3}, {std::nullopt, 1.0, std::nullopt, 2.0});
  EXPECT_FALSE(odometer.distance_m(0.0, 0.3));
  EXPECT_FALSE(odometer.distance_m(0.15, 0.17));
  EXPECT_NEAR(odometer.distance_m(0.0, 0.1).value(), 1.0, 1e-12);
  EXPECT_NEAR(odometer.distance_m(0.2, 0.3).value(), 2.0, 1e-12);
  EXPECT_NEAR(odometer.unknown_s(0.0, 0.3), 0.1, 1e-12);
}

TEST(Odometer, TimesThatRepeatAreSteppedOver) {
  const Odometer odometer({0.0, 0.1, 0.1, 0.2}, {std::nullopt, 1.0, 2.0, 4.0});
  EXPECT_NEAR(odometer.distance_m(0.0, 0.2).value(), 7.0, 1e-12);
  EXPECT_NEAR(odometer.distance_m(0.05, 0.15).value(), 0.5 + 2.0 + 2.0, 1e-12);
}

TEST(Odometer, TakesOnlyWhatWasMeasuredOfADrive) {
  std::vector<FrameResult> results(5);
  for (std::size_t k = 0; k < results.size(); ++k) {
    results[k].time_s = 0.1 * static_cast<double>(k);
    results[k].step_m = 1.0;
    results[k].scaled = true;
    results[k].state = FrameState::kMoving;
  }
  results[2].state = FrameState::kBridged;
  results[4].scaled = false;
  const Odometer odometer(results);
  EXPECT_NEAR(odometer.length_m(), 2.0, 1e-12);
  EXPECT_NEAR(odometer.unknown_s(0.0, 0.4), 0.2, 1e-12);
}

}  // namespace
}  // namespace groundscale
