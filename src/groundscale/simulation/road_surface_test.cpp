#include "groundscale/simulation/road_surface.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace groundscale {
namespace {

/// The smooth shape of roads.
const RoadProfile kSmooth{.roughness_m = 0.0};

RoadSurface straight_road() { return RoadSurface(Path::of_pieces({{100.0, 0.0}}, {}), kSmooth); }

TEST(RoadSurface, ThePathLiesOnTheRoadAtItsOwnHeight) {
  const RoadSurface surface(Path::of_pieces(turn_pieces(1.5, 12.0, 6.0), {{1.0, 60.0, 0.3}}), kSmooth);
  for (const double s : {0.0, 3.3, 9.9, 17.0}) {
    const PathPoint point = surface.path().at(s);
    const RoadPlace place = surface.locate(point.position.x(), point.position.z());
    EXPECT_NEAR(place.on_path.distance_m, s, 1e-3);
    EXPECT_NEAR(place.from_crest_m, 1.75, 1e-3);
    EXPECT_EQ(place.ground, Ground::kRoad);
    EXPECT_NEAR(place.ground_y, point.position.y(), 1e-3);
  }
}

TEST(RoadSurface, IsRoughByAsMuchAsTheProfileSays) {
  const RoadSurface surface(Path::of_pieces({{100.0, 0.0}}, {}), {.crown = 0.0, .roughness_m = 0.005});
  double squares = 0.0;
  int places = 0;
  for (double z = 1.0; z < 99.0; z += 0.7) {
    for (double x = -4.0; x < 1.0; x += 0.7, ++places) squares += std::pow(surface.ground_y(x, z), 2);
  }
  // Waves of up to 6 m over 100 m by 5 m: some fifty independent values.
  EXPECT_NEAR(std::sqrt(squares / places), 0.005, 0.0015);
  // The kerb's foot stays where it is.
  EXPECT_NEAR(surface.ground_y(1.85 - 1e-6, 40.0), 0.0, 1e-6);
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

/// A block that closes and is driven on for another side; from its start to its end it rises by `rise_m`.
Path block(double rise_m) {
  std::vector<PathPiece> pieces;
  for (int side = 0; side < 5; ++side) {
    pieces.push_back({60.0, 0.0});
    for (const PathPiece& piece : turn_pieces(std::numbers::pi / 2.0, 9.0, 6.0)) pieces.push_back(piece);
  }
  return Path::of_pieces(pieces, {{rise_m, 2000.0, 0.0}});
}

TEST(RoadSurface, TwoPassesFindOneGroundBetweenTheirHeights) {
  const Path path = block(0.02);
  const RoadSurface surface(path, kSmooth);
  const double round = path.length_m() / 5.0 * 4.0;
  const PathPoint first = path.at(30.0);
  const PathPoint second = path.at(round + 30.0);
  ASSERT_GT(std::abs(second.position.y() - first.position.y()), 0.005);
  EXPECT_NEAR(surface.ground_y(second.position.x(), second.position.z()),
              0.5 * (first.position.y() + second.position.y()), 1e-3);
  // Its markings are the first pass's.
  EXPECT_NEAR(surface.locate(second.position.x(), second.position.z()).on_path.distance_m, 30.0, 0.1);
}

TEST(RoadSurface, WhereAPathCrossesItselfThereAreNoKerbs) {
  // A loop to the right that crosses its own straight beginning at a right angle.
  std::vector<PathPiece> pieces = {{80.0, 0.0}};
  for (int corner = 0; corner < 3; ++corner) {
    for (const PathPiece& piece : turn_pieces(std::numbers::pi / 2.0, 12.0, 6.0)) pieces.push_back(piece);
  }
  pieces.push_back({60.0, 0.0});
  const Path path = Path::of_pieces(pieces, {});
  const RoadSurface surface(path, kSmooth);
  // Along the last straight, over the first one's kerbs.
  bool crossed = false;
  for (double s = path.length_m() - 60.0; s < path.length_m(); s += 0.5) {
    const PathPoint point = path.at(s);
    const RoadPlace place = surface.locate(point.position.x(), point.position.z());
    EXPECT_EQ(place.ground, Ground::kRoad) << s;
    crossed |= place.junction;
  }
  EXPECT_TRUE(crossed);
}

TEST(RoadSurface, ARoadLeadsOnWhereThePathTurnsOff) {
  std::vector<PathPiece> pieces = {{50.0, 0.0}};
  for (const PathPiece& piece : turn_pieces(std::numbers::pi / 2.0, 9.0, 6.0)) pieces.push_back(piece);
  pieces.push_back({50.0, 0.0});
  const Path path = Path::of_pieces(pieces, {});
  const std::vector<Path> side_roads = side_roads_of(path);
  ASSERT_EQ(side_roads.size(), 1U);
  const RoadSurface surface(path, {}, side_roads);
  EXPECT_EQ(surface.locate(0.0, 80.0).road, 1);
  EXPECT_EQ(surface.locate(0.0, 80.0).ground, Ground::kRoad);
  EXPECT_EQ(RoadSurface(path, {}).locate(0.0, 80.0).ground, Ground::kVerge);
  // The block closes on itself; each of its corners has one. What leads onto the path's own way hasn't.
  EXPECT_TRUE(side_roads_of(Path::of_pieces({{100.0, 0.0}}, {})).empty());
}

TEST(RoadSurface, FarFromThePathThereIsNoRoad) {
  const RoadPlace place = straight_road().locate(500.0, 0.0);
  EXPECT_EQ(place.ground, Ground::kVerge);
  EXPECT_GE(place.from_crest_m, RoadSurface::reach_m());
}

}  // namespace
}  // namespace groundscale
