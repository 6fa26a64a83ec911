// Every plane method on the same made-up frame: 400 points of the road, 500 of the scene, a fifth of the former wrong.
#include <string>

#include <benchmark/benchmark.h>

#include "groundscale/plane/methods.hpp"
#include "groundscale/plane/test_road_internal.hpp"

namespace groundscale {
namespace {

void plane_method(benchmark::State& state) {
  const PlaneMethod& method = plane_methods()[static_cast<std::size_t>(state.range(0))];
  state.SetLabel(std::string(method.name));
  Rng rng(1);
  RoadObservations observations =
      test_road(test_camera(0.015), {.noise_px = 0.2, .wrong_share = 0.2, .count = 400, .scene_count = 500}, rng);
  observations.expected_normal = kTestRoad.normal_in_cam;
  observations.predicted_plane = kTestRoad;
  const EstimatePlane estimate = method.make({});
  for (auto _ : state) benchmark::DoNotOptimize(estimate(observations, rng));
}
BENCHMARK(plane_method)->DenseRange(0, static_cast<int>(plane_methods().size()) - 1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace groundscale
