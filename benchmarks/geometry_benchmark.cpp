#include <benchmark/benchmark.h>

#include "groundscale/geometry/ground_plane.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

const RigidTransform kForward{exp_so3({0.0, 0.02, 0.0}), {0.01, 0.0, -0.9}};
const GroundPlane kRoad{Eigen::Vector3d(0.01, 1.0, 0.02).normalized(), 1.65};

void BM_HomographyOfPlane(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(homography_of_plane(kRoad, kForward));
}
BENCHMARK(BM_HomographyOfPlane);

void BM_PlaneOfHomography(benchmark::State& state) {
  const Eigen::Matrix3d homography = homography_of_plane(kRoad, kForward);
  for (auto _ : state) benchmark::DoNotOptimize(plane_of_homography(homography, kForward));
}
BENCHMARK(BM_PlaneOfHomography);

}  // namespace
}  // namespace groundscale
