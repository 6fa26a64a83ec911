#include "groundscale/simulation/cars.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "groundscale/simulation/material.hpp"

namespace groundscale {
namespace {

constexpr CarKind kKinds[] = {CarKind::kSmall, CarKind::kEstate, CarKind::kSaloon, CarKind::kVan};

TEST(Cars, AreAsLargeAsTheySay) {
  for (const CarKind kind : kKinds) {
    const CarSize size = car_size(kind);
    Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity());
    Eigen::Vector3f high = -low;
    const Meshes meshes = car_meshes({}, kind, 1);
    for (const TriangleMesh& mesh : meshes) {
      ASSERT_EQ(mesh.uv.size(), mesh.vertices.size());
      for (const Eigen::Vector3f& vertex : mesh.vertices) {
        low = low.cwiseMin(vertex);
        high = high.cwiseMax(vertex);
      }
    }
    // Number plates stick out a little in front and behind, mirrors to the sides.
    EXPECT_NEAR(high.z(), 0.5 * size.length_m, 0.02);
    EXPECT_NEAR(low.z(), -0.5 * size.length_m, 0.02);
    EXPECT_NEAR(high.x(), size.half_width_m, 0.2);
    EXPECT_NEAR(low.y(), -size.height_m, 0.01);
    EXPECT_NEAR(high.y(), 0.0, 0.04);  // wheel arches, behind the tyres, reach a little into the ground
    EXPECT_LT(triangles_of(meshes), 700);
  }
}

TEST(Cars, TheSunReachesTheGroundUnderTheSills) {
  // Nothing but tyres lies lower than the ground clearance.
  for (const CarKind kind : kKinds) {
    for (const TriangleMesh& mesh : car_meshes({}, kind, 1)) {
      for (const Eigen::Vector3f& vertex : mesh.vertices) {
        if (-vertex.y() < 0.11F) {
          EXPECT_EQ(mesh.material, material_code(Material::kRubber, 0));
        }
      }
    }
  }
}

TEST(CarFooting, AllFourWheelsStandOnTheGround) {
  const RoadSurface surface(Path::of_pieces(turn_pieces(1.2, 40.0, 10.0), {{1.5, 60.0, 0.3}}), {});
  for (const double s : {3.0, 17.0, 31.0}) {
    const PathPoint point = surface.path().at(s);
    for (const double aside : {0.0, 2.35, -5.85}) {  // on the lane; two wheels on either kerb
      const Footing foot = car_footing(surface, point.position + aside * point.right(), point.heading_rad);
      EXPECT_NEAR(foot.along.norm(), 1.0, 1e-9);
      EXPECT_NEAR(foot.along.dot(foot.up), 0.0, 1e-9);
      EXPECT_NEAR(foot.along.dot(point.forward()), 1.0, 0.05);
      EXPECT_LT(foot.up.y(), -0.98);
      for (const double right : {-0.74, 0.74}) {
        for (const double along : {-1.3, 1.3}) {
          const Eigen::Vector3d wheel = foot.at(right, 0.0, along);
          EXPECT_NEAR(wheel.y(), surface.ground_y(wheel.x(), wheel.z()), 0.05);
        }
      }
    }
  }
}

TEST(ParkedCars, StandAtBothKerbsAndApartFromEachOther) {
  const RoadSurface surface(Path::of_pieces({{300.0, 0.0}}, {}), {});
  WorldOptions options = WorldOptions::bare();
  options.cars_share = 1.0;
  Meshes meshes;
  TakenGround taken;
  Roadside roadside{.surface = surface,
                    .options = options,
                    .path = surface.path(),
                    .begin_m = 0.0,
                    .end_m = 300.0,
                    .taken = taken,
                    .meshes = meshes};
  add_parked_cars(roadside);
  std::vector<double> left;
  std::vector<double> right;
  for (const TriangleMesh& mesh : meshes) {
    if (mesh.material / material_code(Material::kKerb, 0) != static_cast<int>(Material::kPaint)) continue;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3f& vertex : mesh.vertices) sum += vertex.cast<double>();
    sum /= static_cast<double>(mesh.vertices.size());
    const double from_crest = sum.x() + surface.profile().lane_offset_m;
    EXPECT_NEAR(std::abs(from_crest), surface.profile().half_width_m + 0.5, 0.25);
    (from_crest < 0.0 ? left : right).push_back(sum.z());
  }
  for (auto* row : {&left, &right}) {
    EXPECT_GT(row->size(), 40U);
    std::sort(row->begin(), row->end());
    for (std::size_t k = 1; k < row->size(); ++k) EXPECT_GT((*row)[k] - (*row)[k - 1], 3.5);
  }
}

}  // namespace
}  // namespace groundscale
