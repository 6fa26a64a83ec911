#include "groundscale/simulation/traffic.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "groundscale/simulation/roadside.hpp"

namespace groundscale {
namespace {

class TrafficTest : public testing::Test {
 protected:
  TrafficTest()
      : route_(find_route("stop-and-go").value()), surface_(route_.path, {}), drive_(drive(route_, 10.0, {})) {}

  Route route_;
  RoadSurface surface_;
  std::vector<VehicleState> drive_;
};

TEST_F(TrafficTest, EachKeepsToItsLane) {
  const Traffic traffic(surface_, drive_, {.ahead = 2}, 5);
  const double lane = surface_.profile().lane_offset_m;
  int oncoming = 0;
  for (std::size_t k = 0; k < drive_.size(); k += 7) {
    for (const MovingCar& car : traffic.cars_at(drive_[k].time_s)) {
      const RoadPlace place = surface_.locate(car.foot.origin.x(), car.foot.origin.z());
      // Where the path has come back, the crest is that of the first pass, and in a corner both lie apart.
      EXPECT_NEAR(place.from_crest_m, car.oncoming ? -lane : lane, 0.7);
      EXPECT_NEAR(car.foot.along.dot(place.on_path.forward()), car.oncoming ? -1.0 : 1.0, 0.05);
      EXPECT_NEAR(car.foot.origin.y(), surface_.ground_y(car.foot.origin.x(), car.foot.origin.z()), 0.05);
      oncoming += car.oncoming ? 1 : 0;
    }
  }
  EXPECT_GT(oncoming, 10);
}

TEST_F(TrafficTest, NobodyStandsInAnotherOrInTheVehicle) {
  TrafficOptions options{.ahead = 3};
  options.oncoming_every_s = 4.0;
  const Traffic traffic(surface_, drive_, options, 6);
  for (const VehicleState& state : drive_) {
    TakenGround taken;
    const PathPoint own = surface_.path().at(state.distance_m);
    taken.take({own.position, own.forward(), own.right()}, 2.25, 0.9);
    int ahead = 0;
    for (const MovingCar& car : traffic.cars_at(state.time_s)) {
      const CarSize size = car_size(car.kind);
      EXPECT_TRUE(taken.take(car.foot, 0.5 * size.length_m, size.half_width_m)) << "at " << state.time_s;
      ahead += car.oncoming ? 0 : 1;
    }
    // Not by being left out: on a path that doesn't cross itself all of them are there.
    EXPECT_EQ(ahead, 3);
  }
}

TEST_F(TrafficTest, TheOneAheadDoesTheSameTwoSecondsEarlier) {
  TrafficOptions options;
  options.oncoming_every_s = 0.0;
  const Traffic traffic(surface_, drive_, options, 5);
  for (std::size_t k = 0; k + 20 < drive_.size(); k += 13) {
    const auto cars = traffic.cars_at(drive_[k].time_s);
    ASSERT_EQ(cars.size(), 1U);
    EXPECT_NEAR(cars.front().distance_m, drive_[k + 20].distance_m + 7.5, 1e-6);
  }
}

TEST_F(TrafficTest, OncomingCarsMoveTowardsTheVehicleAndNeverJump) {
  TrafficOptions options;
  options.ahead = 0;
  const Traffic traffic(surface_, drive_, options, 5);
  for (std::size_t k = 0; k + 1 < drive_.size(); k += 5) {
    const auto now = traffic.cars_at(drive_[k].time_s);
    const auto next = traffic.cars_at(drive_[k + 1].time_s);
    for (const MovingCar& a : now) {
      for (const MovingCar& b : next) {
        if (a.variant != b.variant) continue;
        EXPECT_LT(b.distance_m, a.distance_m);
        EXPECT_NEAR(a.distance_m - b.distance_m, 0.1 * 0.5 * (3.0 + route_.cruise_mps), 0.06 * route_.cruise_mps);
      }
    }
  }
}

TEST_F(TrafficTest, ASeedDecidesAll) {
  const Traffic one(surface_, drive_, {}, 5);
  const Traffic same(surface_, drive_, {}, 5);
  const Traffic other(surface_, drive_, {}, 6);
  const Meshes first = one.at(20.0);
  const Meshes second = same.at(20.0);
  ASSERT_EQ(first.size(), second.size());
  ASSERT_FALSE(first.empty());
  for (std::size_t k = 0; k < first.size(); ++k) EXPECT_EQ(first[k].vertices, second[k].vertices);
  const auto place_of_all = [](const Traffic& traffic) {
    double sum = 0.0;
    for (const MovingCar& car : traffic.cars_at(20.0)) sum += car.distance_m;
    return sum;
  };
  EXPECT_NE(place_of_all(one), place_of_all(other));
}

}  // namespace
}  // namespace groundscale
