#include "groundscale/simulation/route.hpp"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace groundscale {
namespace {

TEST(Routes, AnUnknownNameListsTheKnownOnes) {
  const auto route = find_route("circle");
  ASSERT_FALSE(route);
  EXPECT_EQ(route.error().message, "'circle' is no route, known: city, straight, hills, stop-and-go, motorway");
}

TEST(Routes, TheCityBlockComesBackToItsStart) {
  const Route route = find_route("city").value();
  constexpr double kHalfSideM = 55.0;
  const double round_m = route.path.length_m() - kHalfSideM;
  EXPECT_LT(route.path.at(round_m).position.norm(), 1e-6);
  EXPECT_NEAR(route.path.at(round_m).heading_rad, 2.0 * M_PI, 1e-9);
  // The second pass lies on the first.
  EXPECT_LT((route.path.at(round_m + 20.0).position - route.path.at(20.0).position).norm(), 1e-6);
}

class EveryRoute : public testing::TestWithParam<std::string_view> {};

TEST_P(EveryRoute, IsDrivenWithinItsLimitsFromStartToEnd) {
  const Route route = find_route(GetParam()).value();
  const DrivingLimits limits;
  constexpr double kRateHz = 10.0;
  const std::vector<VehicleState> states = drive(route, kRateHz, limits);
  ASSERT_GT(states.size(), 100U);
  EXPECT_EQ(states.front().distance_m, 0.0);
  EXPECT_NEAR(states.back().distance_m, route.path.length_m(), route.cruise_mps / kRateHz + 0.1);
  for (std::size_t k = 0; k < states.size(); ++k) {
    const VehicleState& state = states[k];
    EXPECT_DOUBLE_EQ(state.time_s, static_cast<double>(k) / kRateHz);
    EXPECT_LE(state.speed_mps, route.cruise_mps + 1e-9);
    EXPECT_LE(state.acceleration_mps2, limits.acceleration_mps2 + 1e-6);
    EXPECT_GE(state.acceleration_mps2, -limits.braking_mps2 - 1e-6);
    // Limits hold at samples 5 cm apart, curvature grows in between.
    const double curvature = std::abs(route.path.at(state.distance_m).curvature_per_m);
    EXPECT_LE(state.speed_mps * state.speed_mps * curvature, 1.02 * limits.lateral_mps2);
    if (k == 0) continue;
    const double step = state.distance_m - states[k - 1].distance_m;
    // The trapezoid is exact where the acceleration is even, which changes once or twice between frames.
    EXPECT_NEAR(step * kRateHz, 0.5 * (state.speed_mps + states[k - 1].speed_mps), 0.06);
  }
}

INSTANTIATE_TEST_SUITE_P(Names, EveryRoute, testing::ValuesIn(route_names()));

TEST(Drive, WaitsAtStops) {
  const Route route = find_route("stop-and-go").value();
  int waiting = 0;
  for (const VehicleState& state : drive(route, 20.0, {})) {
    if (state.speed_mps == 0.0) ++waiting;
  }
  EXPECT_EQ(waiting, 5 * 4 * 20);
}

}  // namespace
}  // namespace groundscale
