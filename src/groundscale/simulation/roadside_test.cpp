#include "groundscale/simulation/roadside.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "groundscale/simulation/material.hpp"

namespace groundscale {
namespace {

/// A straight, a right turn and a straight, up and down a little.
RoadSurface bent_road() {
  std::vector<PathPiece> pieces = {{120.0, 0.0}};
  for (const PathPiece& piece : turn_pieces(1.4, 14.0, 8.0)) pieces.push_back(piece);
  pieces.push_back({100.0, 0.0});
  return RoadSurface(Path::of_pieces(pieces, {{0.8, 90.0, 0.4}}), {});
}

Meshes all_beside(const RoadSurface& surface, const WorldOptions& options) {
  Meshes meshes;
  TakenGround taken;
  Roadside roadside{.surface = surface,
                    .options = options,
                    .path = surface.path(),
                    .begin_m = -20.0,
                    .end_m = surface.path().length_m() + 20.0,
                    .taken = taken,
                    .meshes = meshes};
  add_roadside(roadside);
  return meshes;
}

TEST(TakenGround, IsFreeOnlyWhereNothingOverlaps) {
  TakenGround ground;
  Footing foot;
  EXPECT_TRUE(ground.take(foot, 5.0, 2.0));
  EXPECT_FALSE(ground.take(foot, 0.1, 0.1));
  foot.origin = {0.0, 3.0, 9.9};  // height doesn't matter
  EXPECT_FALSE(ground.take(foot, 5.0, 2.0));
  foot.origin.z() = 10.1;
  EXPECT_TRUE(ground.take(foot, 5.0, 2.0));
  // Turned by 45 degrees, a corner comes between the bounding boxes without touching.
  foot.along = Eigen::Vector3d(1.0, 0.0, 1.0).normalized();
  foot.right = Eigen::Vector3d(1.0, 0.0, -1.0).normalized();
  foot.origin = {4.2, 0.0, 7.0};
  EXPECT_TRUE(ground.take(foot, 1.5, 1.5));
  foot.origin = {3.9, 0.0, 5.0};
  EXPECT_FALSE(ground.take(foot, 1.5, 1.5));
}

TEST(Roadside, BareIsBare) { EXPECT_TRUE(all_beside(bent_road(), WorldOptions::bare()).empty()); }

TEST(Roadside, ASeedDecidesAll) {
  const RoadSurface surface = bent_road();
  WorldOptions options;
  const Meshes first = all_beside(surface, options);
  const Meshes second = all_beside(surface, options);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_EQ(first[k].material, second[k].material);
    EXPECT_EQ(first[k].vertices, second[k].vertices);
  }
  options.seed = 1;
  EXPECT_NE(all_beside(surface, options).size(), first.size());
}

TEST(Roadside, NothingLowStandsInTheLanes) {
  // Parked cars may stand with a wheel on the road, but leave 2.75 m from the crest free; crowns and lamps hang above
  // it.
  const RoadSurface surface = bent_road();
  constexpr double kFreeM = 2.75;
  constexpr double kHighM = 2.0;
  for (const TriangleMesh& mesh : all_beside(surface, {})) {
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      const RoadPlace place = surface.locate(vertex.x(), vertex.z());
      const double up = surface.ground_y(vertex.x(), vertex.z()) - static_cast<double>(vertex.y());
      if (up < kHighM) {
        ASSERT_GT(std::abs(place.from_crest_m), kFreeM) << "material " << mesh.material << ", up " << up;
      }
    }
  }
}

TEST(Roadside, AKindLeftOutDoesNotMoveTheHouses) {
  const RoadSurface surface = bent_road();
  WorldOptions only_houses = WorldOptions::bare();
  only_houses.houses_share = WorldOptions{}.houses_share;
  const Meshes some = all_beside(surface, only_houses);
  const Meshes all = all_beside(surface, {});
  ASSERT_GT(some.size(), 20U);
  for (std::size_t k = 0; k < some.size(); ++k) EXPECT_EQ(some[k].vertices, all[k].vertices);
}

TEST(Roadside, ASecondPassPutsNothingMore) {
  // Out and back along the same road: what the first pass has put leaves no room.
  const RoadSurface surface(Path::of_pieces({{200.0, 0.0}}, {}), {});
  WorldOptions options = WorldOptions::bare();
  options.houses_share = 1.0;
  Meshes meshes;
  TakenGround taken;
  Roadside roadside{.surface = surface,
                    .options = options,
                    .path = surface.path(),
                    .begin_m = 0.0,
                    .end_m = 200.0,
                    .taken = taken,
                    .meshes = meshes};
  add_roadside(roadside);
  const std::size_t once = meshes.size();
  EXPECT_GT(once, 0U);
  add_roadside(roadside);
  EXPECT_EQ(meshes.size(), once);
}

TEST(Roadside, TrianglesStayFew) {
  // Memory: a drive of 3.7 km with both sides built is to stay below 3 million.
  const RoadSurface surface(Path::of_pieces({{460.0, 0.0}}, {}), {});
  EXPECT_LT(triangles_of(all_beside(surface, {})), 400000);  // over 500 m
}

}  // namespace
}  // namespace groundscale
