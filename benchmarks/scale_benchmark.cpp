#include <benchmark/benchmark.h>

#include "groundscale/plane/point_plane.hpp"
#include "groundscale/scale/scale_keeper.hpp"
#include "groundscale/scale/test_foreign_map_internal.hpp"

namespace groundscale {
namespace {

/// Argument: road points.
void BM_FitPointPlane(benchmark::State& state) {
  Rng rng(3);
  PlanePoints points;
  for (int k = 0; k < state.range(0); ++k) {
    points.points_in_cam.emplace_back(rng.uniform(-2.0, 2.0), 1.65 + 0.02 * rng.normal(), rng.uniform(-4.0, 10.0));
    points.weights.push_back(rng.uniform());
  }
  for (int k = 1; k <= 8; ++k) points.centres_in_cam.emplace_back(0.0, 0.0, -1.0 * k);
  points.expected_normal = Eigen::Vector3d::UnitY();
  for (auto _ : state) benchmark::DoNotOptimize(fit_point_plane(points, {}));
}
BENCHMARK(BM_FitPointPlane)->Arg(100)->Arg(300)->Arg(1000)->Unit(benchmark::kMicrosecond);

/// A frame: some 300 road points, 20 m of poses. Argument: a ScaleCorrection.
void BM_ScaleKeeperAdvance(benchmark::State& state) {
  ForeignDrive drive;
  drive.frames = 100;
  const ForeignMap map(drive);
  std::vector<ScaleKeeper::Input> inputs;
  for (int k = 0; k < map.frames(); ++k) inputs.push_back(map.input(k));
  ScaleKeeper keeper(ForeignMap::kHeightM, static_cast<ScaleCorrection>(state.range(0)), {});
  keeper.start(1.0, 0.1);
  std::size_t k = 0;
  double time_s = 0.0;
  for (auto _ : state) {
    ScaleKeeper::Input& input = inputs[30 + k++ % 60];
    input.time_s = time_s += 0.1;
    benchmark::DoNotOptimize(keeper.advance(input));
  }
  state.counters["points"] = static_cast<double>(inputs[60].road_points_in_world.size());
}
BENCHMARK(BM_ScaleKeeperAdvance)
    ->Arg(static_cast<int>(ScaleCorrection::kTriggered))
    ->Arg(static_cast<int>(ScaleCorrection::kFiltered))
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace groundscale
