#include <benchmark/benchmark.h>

#include "groundscale/geometry/so3.hpp"
#include "groundscale/mapping/bundle_adjustment.hpp"
#include "groundscale/mapping/resection.hpp"
#include "groundscale/mapping/test_street_internal.hpp"
#include "groundscale/mapping/triangulation.hpp"

namespace groundscale {
namespace {

CameraPtr camera_of(std::int64_t kind) { return test_camera(static_cast<TestCamera>(kind)); }

Bundle start_of(const CameraPtr& camera, int longest_track) {
  Rng rng(7);
  Bundle bundle = street(camera, {.points = 400, .longest_track = longest_track, .noise_px = 0.3}, rng);
  disturb(bundle, 0.002, 0.02, 0.02, rng);
  return bundle;
}

/// Arguments: camera (0 pinhole, 1 with distortion, 2 fisheye), longest track, loss.
void BM_AdjustBundle(benchmark::State& state) {
  const Bundle start = start_of(camera_of(state.range(0)), static_cast<int>(state.range(1)));
  BundleOptions options;
  options.min_relative_decrease = 0.0;  // all five steps
  options.loss = static_cast<BundleLoss>(state.range(2));
  BundleSummary summary;
  for (auto _ : state) {
    Bundle bundle = start;
    summary = adjust_bundle(bundle, options).value();
    benchmark::DoNotOptimize(bundle);
  }
  state.counters["observations"] = summary.observations;
  state.counters["steps"] = summary.iterations;
  state.counters["px"] = summary.final_rms_px;
}
BENCHMARK(BM_AdjustBundle)
    ->Args({0, 7, 0})
    ->Args({0, 7, 1})
    ->Args({1, 7, 0})
    ->Args({2, 7, 0})
    ->Args({0, 12, 0})
    ->Unit(benchmark::kMillisecond);

void BM_Triangulate(benchmark::State& state) {
  const CameraPtr camera = camera_of(state.range(0));
  Rng rng(7);
  const Bundle bundle = street(camera, {.points = 400, .longest_track = 6, .noise_px = 0.3}, rng);
  std::vector<std::vector<Sight>> points(400);
  for (const BundleObservation& o : bundle.observations) {
    points[static_cast<std::size_t>(o.point)].push_back(
        {bundle.views[static_cast<std::size_t>(o.view)].cam_from_world, camera->ray(o.pixel).value(), o.pixel});
  }
  std::erase_if(points, [](const auto& sights) { return sights.size() != 6; });
  std::size_t k = 0;
  int found = 0;
  int tried = 0;
  for (auto _ : state) {
    const auto point = triangulate(points[k++ % points.size()], *camera);
    found += point.has_value() ? 1 : 0;
    ++tried;
    benchmark::DoNotOptimize(point);
  }
  state.counters["found"] = static_cast<double>(found) / tried;
}
BENCHMARK(BM_Triangulate)->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMicrosecond);

std::vector<PointSight> sights_of_street(const CameraPtr& camera, double wrong_share) {
  Rng rng(8);
  std::vector<PointSight> sights;
  while (sights.size() < 300) {
    const Eigen::Vector3d point = street_point(*camera, rng);
    const double spread_px = rng.uniform() < wrong_share ? 50.0 : 0.3;
    sights.push_back({point, *camera->project(point) + spread_px * normal2(rng)});
  }
  return sights;
}

void BM_RefinePose(benchmark::State& state) {
  const CameraPtr camera = camera_of(state.range(0));
  const auto sights = sights_of_street(camera, 0.3);
  const RigidTransform guess{exp_so3({0.005, 0.01, 0.0}), {0.1, 0.0, 0.3}};
  for (auto _ : state) benchmark::DoNotOptimize(refine_pose(sights, *camera, guess, {}));
}
BENCHMARK(BM_RefinePose)->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMicrosecond);

void BM_Resect(benchmark::State& state) {
  const CameraPtr camera = camera_of(0);
  const auto sights = sights_of_street(camera, 0.3);
  Rng rng(9);
  for (auto _ : state) benchmark::DoNotOptimize(resect(sights, *camera, {}, rng));
}
BENCHMARK(BM_Resect)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace groundscale
