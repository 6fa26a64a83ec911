#include "groundscale/simulation/road_surface.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace groundscale {
namespace {

RoadSurface straight_road() { return RoadSurface(Path::of_pieces({{100.0, 0.0}}, {}), {}); }

TEST(RoadSurface, ThePathLiesOnTheRoadAtItsOwnHeight) {
  const RoadSurface surface(Path::of_pieces(turn_pieces(1.5, 12.0, 6.0), {{1.0, 60.0, 0.3}}), {});
  for (const double s : {0.0, 3.3, 9.9, 17.0}) {
    const PathPoint point = surface.path().at(s);
    const RoadPlace place = surface.locate(point.position.x(), point.position.z());
    EXPECT_NEAR(place.on_path.distance_m, s, 1e-3);
    EXPECT_NEAR(place.from_crest_m, 1.75, 1e-3);
    EXPECT_EQ(place.ground, Ground::kRoad);
    EXPECT_NEAR(surface.ground_y(place), point.position.y(), 1e-3);
  }
}

TEST(RoadSurface, TheCrossSectionIsTheProfiles) {
  const RoadSurface surface = straight_road();
  const double lane = 0.02 * 1.75;
  // Crest, 1.75 m to the left of the path, is higher by the crown.
  EXPECT_NEAR(surface.ground_y(-1.75, 50.0), -lane, 1e-9);
  EXPECT_EQ(surface.locate(-1.75, 50.0).ground, Ground::kRoad);
  // Just before the right kerb, and on it.
  EXPECT_NEAR(surface.ground_y(1.84, 50.0), 0.02 * 3.59 - lane, 1e-9);
  EXPECT_EQ(surface.locate(1.95, 50.0).ground, Ground::kKerb);
  EXPECT_NEAR(surface.ground_y(1.95, 50.0), 0.02 * 3.6 - 0.12 - lane, 1e-9);
  EXPECT_EQ(surface.locate(3.0, 50.0).ground, Ground::kPavement);
  EXPECT_EQ(surface.locate(6.0, 50.0).ground, Ground::kVerge);
  // The verge rises by 5 % for 6 m.
  EXPECT_NEAR(surface.ground_y(30.0, 50.0), 0.02 * 3.6 - 0.12 - 0.3 - lane, 1e-9);
}

TEST(RoadSurface, ASecondPassFindsTheWorldAsItWas) {
  // A block that closes; its second round lies 20 cm higher by its own height, but the first round has made the world.
  std::vector<PathPiece> pieces;
  for (int side = 0; side < 5; ++side) {
    pieces.push_back({60.0, 0.0});
    for (const PathPiece& piece : turn_pieces(std::numbers::pi / 2.0, 9.0, 6.0)) pieces.push_back(piece);
  }
  const Path path = Path::of_pieces(pieces, {{0.2, 1000.0, 0.0}});
  const RoadSurface surface(path, {});
  const double round = path.length_m() / 5.0 * 4.0;
  const PathPoint first = path.at(30.0);
  const PathPoint second = path.at(round + 30.0);
  ASSERT_GT(std::abs(second.position.y() - first.position.y()), 0.01);
  EXPECT_NEAR(surface.ground_y(second.position.x(), second.position.z()), first.position.y(), 1e-3);
}

TEST(RoadSurface, FarFromThePathThereIsNoRoad) {
  const RoadPlace place = straight_road().locate(500.0, 0.0);
  EXPECT_EQ(place.ground, Ground::kVerge);
  EXPECT_GE(place.from_crest_m, RoadSurface::reach_m());
}

}  // namespace
}  // namespace groundscale
